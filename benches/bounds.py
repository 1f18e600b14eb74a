"""Every strategy's links against their bounds: `python3 benches/bounds.py PROGRAM MODEL...`.

Each print and each layer, under every scope, with free and pinned seams, in length and in time, by every strategy. The bounds are
those of `--effort fast`, since a program built with HiGHS takes long for others; EFFORT in the environment names another. One line
for each print; at the end how many layers there were, and which came nearest to its bound. Exit code 1 if any is below.
"""

import itertools
import json
import os
import subprocess
import sys

# Links and their bound: in millimetres, in seconds.
MEASURES = [("link_mm", "bound_mm"), ("travel_s", "bound_s")]
# Sums of floating-point numbers.
ROUNDING = 1e-6


def main() -> int:
    program, *models = sys.argv[1:]
    effort = os.environ.get("EFFORT", "fast")
    prints = layers = below = 0
    least = (float("inf"), "nothing")
    for model, scope, seam in itertools.product(models, ["feature", "layer", "island"], ["pinned", "free"]):
        options = ["--scope", scope, "--seam", seam, "--cost", "time", "--effort", effort]
        command = [program, "compare", model, "--profile", "standard-job", "--threads", "1", "--json", *options]
        run = subprocess.run(command, capture_output=True, text=True)
        name = f"{os.path.basename(model)} {scope} {seam}"
        if run.returncode:
            print(f"{name}: exit code {run.returncode}: {run.stderr.strip()[-200:]}", flush=True)
            continue
        for row in json.loads(run.stdout)["strategies"]:
            prints += 1
            layers += len(row["layers"])
            for part, (links, bound) in itertools.product([row, *row["layers"]], MEASURES):
                excess = part[links] - part[bound]
                what = f"{name} {row['strategy']} layer {part.get('layer', 'all')} {links}"
                # A layer without links is at its bound.
                if part["travels"]:
                    least = min(least, (excess, what))
                if excess < -ROUNDING:
                    below += 1
                    print(f"BELOW {what}: {part[links]} < {part[bound]}", flush=True)
        print(f"{name}: {prints} prints, {layers} layers, {below} below, least excess {least}", flush=True)
    return below > 0


if __name__ == "__main__":
    sys.exit(main())
