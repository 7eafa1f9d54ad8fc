"""The command line: one file per command; ``app`` joins the commands, ``console`` has the parts that they share."""
