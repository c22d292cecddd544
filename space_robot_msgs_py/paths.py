"""What a path may be given as."""

import os

# Text, a ``Path``, or anything that stands for one, such as a finished run for its directory.
StrPath = str | os.PathLike[str]
