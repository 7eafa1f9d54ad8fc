"""Engines in processes of their own, in any language, over stdin and stdout; docs/bridge.md specifies the protocol."""
