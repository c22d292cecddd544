#!/usr/bin/env bash
# proxsuite reports a QP whose bounds are crossed (1 <= x <= -1) as solved, with a primal residual of 0.
#
# proxsuite 0.8.0, qpsolvers 4.13.0, NumPy 2.4.6, Python 3.11, Linux.
#
# The x reported is the middle of the two bounds and violates each by 1; the residual looks as if both violations were added
# with their signs. With other costs the same bounds may also end at the limit of iterations. So limits that an error has
# swapped, of a symmetric range for instance, give a "solved" x that keeps neither. qpsolvers passes it on: found is True.
# Cure: check lower <= upper before, or x against both bounds after the solution.
#
# Seen: "1 <= x <= -1: PROXQP_SOLVED, x = 0.0, residual 0.0; qpsolvers: found True; quadprog: found False"
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/python -m pip install -q --disable-pip-version-check proxsuite==0.8.0 qpsolvers==4.13.0 quadprog==0.1.14 numpy==2.4.6

cat > crossed.py <<'PY'
import sys
import numpy as np
import proxsuite
import qpsolvers

weight, linear, lower, upper = np.eye(1), np.zeros(1), np.array([1.0]), np.array([-1.0])
problem = proxsuite.proxqp.dense.QP(1, 0, 1)
problem.init(weight, linear, None, None, np.eye(1), lower, upper)
problem.solve()
status, x, residual = problem.results.info.status.name, abs(problem.results.x[0]), problem.results.info.pri_res
found = {name: qpsolvers.solve_problem(qpsolvers.Problem(weight, linear, lb=lower, ub=upper), solver=name).found
         for name in ("proxqp", "quadprog")}
print(f"1 <= x <= -1: {status}, x = {x}, residual {residual}; qpsolvers: found {found['proxqp']}; "
      f"quadprog: found {found['quadprog']}")
sys.exit(0 if status == "PROXQP_SOLVED" and x < 1e-6 and residual < 1e-6 and found == {"proxqp": True, "quadprog": False}
         else 1)
PY
venv/bin/python crossed.py
