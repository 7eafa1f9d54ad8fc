"""Engines in separate processes, in any language, over stdin and stdout; docs/bridge.md specifies the protocol."""
