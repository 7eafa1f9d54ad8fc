"""The command line: one file per command; ``app`` joins the commands, and ``console`` contains their shared parts."""
