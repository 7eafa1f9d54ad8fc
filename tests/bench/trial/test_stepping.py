"""Instructions of the core are those of its update without those of the port, if they are counted at all."""

from bench.trial.stepping import SteeredFrames
from bench.trial.timed_port import CountedPort
from scenarios.planks import lay

OF_CALL, OF_READING = 3, 1000


class Processor:
    """Counts instructions: each reading of the counter takes some, and each reading of contacts many."""

    def __init__(self) -> None:
        self.instructions = 0

    def count(self) -> int:
        self.instructions += OF_CALL
        return self.instructions


def test_instructions_of_the_port_are_not_the_cores(fake_engine, monkeypatch) -> None:
    simulation, processor = fake_engine(), Processor()
    simulation.spawn(lay(0, level=1))
    read = simulation.port.contacts

    def slow():
        processor.instructions += OF_READING
        return read()

    monkeypatch.setattr(simulation.port, "contacts", slow)
    _, steering = SteeredFrames(simulation, "at_rest", processor.count).play()
    assert processor.instructions > OF_READING
    assert steering.instructions is not None
    assert 0 < steering.instructions < OF_READING, "only readings of the counter itself"


def test_without_a_counter_there_are_no_instructions(fake_engine) -> None:
    simulation = fake_engine()
    simulation.spawn(lay(0, level=1))
    _, steering = SteeredFrames(simulation, "at_rest").play()
    assert steering.instructions is None


def test_a_counted_port_starts_anew_with_a_frame(fake_engine) -> None:
    simulation, processor = fake_engine(), Processor()
    body = simulation.spawn(lay(0, level=1))
    port = CountedPort(simulation.port, processor.count)
    port.masses()
    port.sleep([body])
    port.wake([body])
    assert port.instructions == 3 * OF_CALL
    port.reset()
    assert port.instructions == 0
