#!/usr/bin/env bash
# Vector environments of gymnasium cut the numbers of `info` to the type that the first environment happens to give.
#
# gymnasium 1.4.0, NumPy 2.3.5, Python 3.11, Linux.
#
# The infos of the environments are merged into one array for each key. Its dtype is that of the value which the first
# environment with the key has given in this step: after an int 0 the 0.75 of the others is stored as 0, after True every
# number is True, and an integer array does the same to the float arrays. So a distance that is exactly 0 in environment 0
# silently makes the distances of all others whole numbers, in this one step. The result depends on the order of the
# environments. Cure: give a key the same type in all of them, and always a float for a number.
#
# Seen: "environment 0 gives 0, then 0.0, the other two 0.75 and 2.5"
#       "distance [0, 0, 2], then [0.0, 0.75, 2.5]; force after True: [True, True, True]; vector: [[1, 2], [0, 2], [0, 2]]"
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3}" -m venv venv
venv/bin/python -m pip install -q --disable-pip-version-check gymnasium==1.4.0 numpy==2.3.5

cat > infos.py <<'PY'
import sys
import gymnasium
import numpy as np

class Arm(gymnasium.Env):
    observation_space = gymnasium.spaces.Box(-1, 1, (1,), np.float64)
    action_space = gymnasium.spaces.Box(-1, 1, (1,), np.float64)

    def __init__(self, index):
        self.index, self.steps = index, 0

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        return np.zeros(1), {}

    def step(self, action):
        self.steps += 1
        info = {"distance": (0 if self.steps == 1 else 0.0, 0.75, 2.5)[self.index],
                "force": (True, 7.5, 0.25)[self.index],
                "vector": (np.array([1, 2]), np.array([0.5, 2.5]), np.array([0.5, 2.5]))[self.index]}
        return np.zeros(1), 0.0, False, False, info

seen = []
for kind in (gymnasium.vector.SyncVectorEnv, gymnasium.vector.AsyncVectorEnv):
    vector = kind([lambda index=index: Arm(index) for index in range(3)])
    vector.reset(seed=0)
    first, second = [vector.step(np.zeros((3, 1)))[4] for _ in range(2)]
    vector.close()
    seen.append((first["distance"].tolist(), second["distance"].tolist(), first["force"].tolist(),
                 first["vector"].tolist()))
print("environment 0 gives 0, then 0.0, the other two 0.75 and 2.5")
print("distance {}, then {}; force after True: {}; vector: {}".format(*seen[0]))
cut = ([0, 0, 2], [0.0, 0.75, 2.5], [True, True, True], [[1, 2], [0, 2], [0, 2]])
sys.exit(0 if seen == [cut, cut] else 1)
PY
venv/bin/python infos.py
