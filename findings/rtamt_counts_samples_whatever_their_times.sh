#!/usr/bin/env bash
# rtamt judges a whole trace in discrete time by counting samples, whatever their times, and counts no violation of sampling.
#
# rtamt 0.4.10, Python 3.11, Linux.
#
# evaluate() of StlDiscreteTimeSpecification takes a column "time" and does not use it: a bound of 2 s is two samples (the
# period is 1 s by default). A value at 5 s then fulfils "eventually within 2 s" at 0.2 s. The package counts irregular
# samples in sampling_violation_counter, but only update() does; after evaluate() it is 0 for the same times.
# Cure: resample to the period given to set_sampling_period, or use StlDenseTimeSpecification.
#
# Seen: "positive only at 5 s; eventually[0:2] at 0.2 s: 3.0; violations counted: evaluate 0, update 4"
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/python -m pip install -q --disable-pip-version-check rtamt==0.4.10

cat > times.py <<'PY'
import logging, sys
import rtamt

logging.disable()
TIMES, VALUES = [0, 0.1, 0.2, 0.3, 5.0], [-1.0, -1.0, -1.0, -1.0, 3.0]

def monitor(formula):
    specification = rtamt.StlDiscreteTimeSpecification()
    specification.declare_var("x", "float")
    specification.spec = f"out = {formula}"
    specification.parse()
    return specification

whole, online = monitor("eventually[0:2](x > 0)"), monitor("once[0:2](x > 0)")
robustness = whole.evaluate({"time": TIMES, "x": VALUES})[2][1]
for time, value in zip(TIMES, VALUES):
    online.update(time, [("x", value)])
counted = whole.sampling_violation_counter, online.sampling_violation_counter
print(f"positive only at 5 s; eventually[0:2] at 0.2 s: {robustness}; violations counted: evaluate {counted[0]}, "
      f"update {counted[1]}")
sys.exit(0 if robustness == 3.0 and counted == (0, 4) else 1)
PY
venv/bin/python times.py
