"""The command line, with one file per command: ``app`` joins the commands, ``console`` contains their shared parts."""
