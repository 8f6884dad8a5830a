# The extension module. What users call is in the modules beside it, which have types and docstrings.
from typing import Any

__version__: str

def __getattr__(name: str) -> Any: ...
