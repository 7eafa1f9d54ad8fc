"""Descriptions of set-ups for the page, from the environment of a results folder."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from reports.statistics.ranking import Ranking


def first_place(ranking: Ranking, engines: Mapping[str, Any]) -> dict[str, str] | None:
    """Return the set-up in the first place: engine, profile, policy, ``settings`` and ``link``.

    ``settings`` describes the profile, and ``link`` is the id of the section of the profile.

    The result is None if no set-up has a place, or if the environment does not describe the profile.
    """
    if not ranking.places:
        return None
    set_up = ranking.places[0].set_up
    settings = set_up_description(engines, set_up.engine, set_up.profile)
    link = f"set-{set_up.engine}-{set_up.profile.partition('@')[0]}"
    return {**set_up._asdict(), "settings": settings, "link": link} if settings else None


def set_up_description(engines: Mapping[str, Any], engine: str, profile: str) -> str:
    """Return the description of a profile in the environment, followed by the variation of the profile, if any.

    The text is empty if the environment does not describe the profile.
    """
    name, _, varied = profile.partition("@")
    described: str = engines.get(engine, {}).get("profiles", {}).get(name, {}).get("description", "")
    return f"{described}; {varied}" if described and varied else described
