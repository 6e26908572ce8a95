"""All that each module of the kernel may use without naming it: structs, kinds, and the arithmetic of vectors.

Of other modules' functions each module names those that it calls. The compiled kernel does without these imports: all
is in one module there (headers.py).
"""

from __future__ import annotations

from heuncli.kernel.algebra import *
from heuncli.kernel.programs import *
from heuncli.kernel.scene import *
from heuncli.kernel.shadow import cython as cython
from heuncli.kernel.stepping import *
from heuncli.kernel.values import *
