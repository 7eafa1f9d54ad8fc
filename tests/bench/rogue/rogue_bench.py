"""The command line with the misbehaving engine registered. Every trial's process runs this file's upper part too.

The commit is whatever a test says, so that nothing else that happens to the checkout plays a part. A report is made
where a test asks for one, because it takes longer than the trials.
"""

import os

from adapters.engines import ENGINES, Entry

ENGINES["rogue"] = Entry("rogue_engine", "RogueSimulation", "numpy")

if __name__ != "__main__" and "GRACE_IN_TRIALS_S" in os.environ:  # a trial's own alarm rings before the harness acts
    from bench.execution import worker

    worker.GRACE_S = float(os.environ["GRACE_IN_TRIALS_S"])

if __name__ == "__main__":
    import signal

    signal.signal(signal.SIGINT, signal.SIG_DFL)
    from bench.cli import run
    from bench.cli.app import app
    from bench.execution import worker

    worker.GRACE_S = float(os.environ.get("GRACE_S", "1"))
    if "REPORT" not in os.environ:
        run.make_report = run.show = lambda _: None
    run.describe = lambda _: {"commit": os.environ.get("COMMIT", "c0ffee")}
    app()
