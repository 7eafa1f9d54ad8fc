"""Set-ups are ranked by correct outcomes of the whole study, then by frame time."""

from reports.statistics.groups import groups_of
from reports.statistics.pairs import ALL, SetUp, pair_rows
from reports.statistics.ranking import Creep, rank
from scenarios.model import Expectation
from tests.reports.studies import FALLS, STANDS, failed, fallen, record


def pair(name: str, *, fall: str = "right", stand: str = "right", seed: int = 0, **fields):
    sides = (("stand", STANDS, stand), ("fall", FALLS, fall))
    return [
        record(scene=f"{name}-{side}", pair=name, expectation=theory, verdict=verdict, seed=seed, **fields)
        for side, theory, verdict in sides
    ]


def ranked(*trials):
    return rank(groups_of(trials))


def order(ranking) -> list[str]:
    return [place.set_up.engine for place in ranking.places]


def test_most_right_comes_first_then_fewest_wrong_then_the_cheapest() -> None:
    ranking = ranked(
        *pair("a", fall="false_stand", frame_ms_p50=0.1),
        *pair("b"),
        *pair("a", engine="slow", frame_ms_p50=5.0),
        *pair("b", engine="slow", frame_ms_p50=5.0),
        *pair("a", engine="fast", frame_ms_p50=2.0),
        *pair("b", engine="fast", frame_ms_p50=2.0),
        *pair("a", engine="stopped", fall="undecided", status="timeout"),
        *pair("b", engine="stopped"),
    )
    assert order(ranking) == ["fast", "slow", "stopped", "bullet"]
    assert [place.set_up.engine for place in ranking.all_right] == ["fast", "slow"]
    assert (ranking.pairs, ranking.scenes, len(ranking.units)) == (2, 0, 2)


def test_what_a_set_up_cannot_play_or_has_no_record_of_is_not_right() -> None:
    ranking = ranked(
        *pair("a"),
        *pair("b"),
        *pair("a", engine="planar"),
        failed("unsupported", scene="b-stand", pair="b", engine="planar"),
        failed("unsupported", scene="b-fall", pair="b", engine="planar", expectation=FALLS),
        *pair("a", engine="interrupted"),
        *pair("b", engine="interrupted")[:1],
    )
    by_engine = {place.set_up.engine: place for place in ranking.places}
    assert [place.set_up.engine for place in ranking.all_right] == ["bullet"]
    assert by_engine["planar"].states == {"right": 1, "not_playable": 1}
    assert (by_engine["interrupted"].right, by_engine["interrupted"].missing) == (1, 1)
    assert ranking.scenes == 0, "the side of an interrupted pair is no scene by itself"


def test_scenes_without_a_partner_count_beside_pairs() -> None:
    ranking = ranked(
        *pair("a"), fallen(9, scene="wall"), *pair("a", engine="dart"), record(scene="wall", engine="dart")
    )
    assert order(ranking) == ["dart", "bullet"]
    assert (ranking.pairs, ranking.scenes) == (1, 1)


def test_counts_of_pairs_are_those_of_the_table_of_pairs() -> None:
    trials = [
        *(trial for seed in range(3) for trial in pair("a", seed=seed, fall="false_stand" if seed else "right")),
        *(trial for seed in range(3) for trial in pair("b", seed=seed, stand="creeps" if seed == 1 else "right")),
    ]
    (place,) = ranked(*trials).places
    (row,) = (row for row in pair_rows(groups_of(trials)) if row.family == ALL)
    assert row.success_rates is not None
    assert (place.right, place.right + place.wrong) == (row.success_rates.right_count, row.success_rates.n) == (3, 6)
    assert place.states == {"right": 3, "false_stand": 2, "creeps": 1}


def test_repeats_count_once_and_scenes_without_a_known_answer_never() -> None:
    trials = [record(), record(repeat=1, verdict="creeps", trial="again")]
    (place,) = ranked(*trials).places
    assert place.states == {"right": 1}
    assert not ranked(record(expectation=Expectation("study", "nobody knows"), verdict="none")).units


def test_the_creep_of_a_set_up_is_that_nearest_to_its_limit() -> None:
    ranking = ranked(
        record(scene="thick", creep_m_s=3e-6, creep_limit_m_s=9e-6),
        record(scene="thin", creep_m_s=1e-6, creep_limit_m_s=1.3e-6),
        record(scene="falling", expectation=FALLS, creep_m_s=1.0, creep_limit_m_s=1e-6),
        record(scene="neutral", verdict="none", creep_m_s=1.0, creep_limit_m_s=1e-6),
    )
    assert ranking.places[0].creep == Creep(1e-6, 1.3e-6)
    assert ranking.places[0].set_up == SetUp("bullet", "game", "none")
