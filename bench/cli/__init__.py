"""The command line: one file per verb; ``app`` joins the verbs, ``console`` has the parts that they share."""
