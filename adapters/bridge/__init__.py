"""Engines in separate processes, in any language, over stdin and stdout (protocol: docs/bridge.md)."""
