"""Compile the completion of contacts in the fork server, so that trials inherit the compiled kernels in memory."""

from adapters.shared.contact_completion import prepare

prepare()
