#!/usr/bin/env bash
# Finds the commit of your engine after which bricks no longer stand. In the repository of your engine:
#   export STILLSTACK=~/stillstack ENGINE=bullet          a checkout of the suite after 'uv sync --locked', your engine
#   export GOOD=~/stillstack/good.json                    the baseline of the good commit, by 'bench baseline'
#   git bisect start BAD_COMMIT GOOD_COMMIT && git bisect run ~/stillstack/docs/examples/ci/bisect.sh
# Exit status, as 'git bisect run' understands it: 0 good, 1 bad, 125 this commit cannot be judged.
set -uo pipefail
wheels=$(mktemp -d)
trap 'rm -rf "$wheels"' EXIT
commit=$(git rev-parse --short HEAD)
pip wheel . --no-deps --wheel-dir "$wheels" || exit 125
cd "$STILLSTACK" || exit 125
uv pip install --reinstall --no-deps "$wheels"/*.whl || exit 125
uv run --no-sync -m bench run smoke --engine "$ENGINE" --no-report --out "results/bisect-$commit" || exit 125
uv run --no-sync -m bench compare "$GOOD" "results/bisect-$commit" --engine "$ENGINE" --fail-on outcome --across-versions
status=$?
if [ "$status" -gt 1 ]; then exit 125; fi
exit "$status"
