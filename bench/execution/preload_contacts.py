"""Compile the completion of contacts in the fork server, so that no trial that reads contacts pays for it."""

from adapters.shared.contact_completion import prepare

prepare()
