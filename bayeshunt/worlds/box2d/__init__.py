"""The world that ships, in Box2D."""

import warnings

with warnings.catch_warnings():
    # SWIG's types lack a __module__: the warning of it, made an error (python -W error), would crash the interpreter
    warnings.filterwarnings("ignore", "builtin type [Ss]wig.* has no __module__ attribute", DeprecationWarning)
    import Box2D  # noqa: F401
