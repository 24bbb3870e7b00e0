"""`python -m tests.support.run_file FILE ARGUMENT...`: runs a file as a program, for tests with processes."""

from __future__ import annotations

import runpy
import sys

if __name__ == "__main__":
    sys.argv.pop(0)
    runpy.run_path(sys.argv[0], run_name="__main__")
