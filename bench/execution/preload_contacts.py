"""Compile the completion of contacts in the fork server, so that no trial has to compile it."""

from adapters.shared.contact_completion import prepare

prepare()
