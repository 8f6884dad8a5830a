"""Bends and grafts detailed meshes.

Lengths and coordinates are in the units of the mesh, angles in degrees. Vertices are numbered from 0. docs/python.md
shows how it is used.

    import meshgraft as mg

    octopus = mg.sample("octopus")
    arm = mg.select.sphere((1.8, 0, 0.3), 0.6)
    bent = mg.deform(octopus, region=arm.grow(12), handles={"arm": arm}, poses={"arm": mg.Pose(rotate=("z", 40))})
"""

from meshgraft import select
from meshgraft._core import __version__
from meshgraft._deform import Deformer, HandleBasis, ProxyDeformer, ReducedFrames, deform, estimated_memory
from meshgraft._edit import Edit, EditResult, MethodOutcome, compare, methods
from meshgraft._editor import Editing, edit
from meshgraft._facts import (Cancelled, Error, FileError, InputError, Note, NoteWarning, OutOfMemoryError,
                              UnsolvableError, UsageError)
from meshgraft._live import LiveDeformer, LiveFrame
from meshgraft._merge import MergeResult, drop, merge
from meshgraft._mesh import Attributes, Mesh, read, sample, samples, write
from meshgraft._picture import Picture, picture
from meshgraft._pose import Handle, Pose
from meshgraft._records import (CutResult, DeformerSummary, Diagnostics, EdgePoints, EditReport, EvaluationReport, Finding,
                                MergeReport, ProxySummary, Quality, RepairChange, RepairResult, SampleInfo, StepReport,
                                TopologySummary, WriteResult)
from meshgraft._repair import check, cut, quality, repair, self_intersections
from meshgraft._vertex_deform import VertexDeformer
from meshgraft.select import Selection

__all__ = [
    "Attributes", "Cancelled", "CutResult", "Deformer", "DeformerSummary", "Diagnostics", "EdgePoints", "Edit",
    "EditReport", "EditResult", "Editing", "Error", "EvaluationReport", "FileError", "Finding", "Handle", "HandleBasis", "InputError",
    "LiveDeformer", "LiveFrame", "MergeReport", "MergeResult", "Mesh", "MethodOutcome", "Note", "NoteWarning", "OutOfMemoryError",
    "Picture", "Pose", "ProxyDeformer", "ProxySummary", "Quality", "ReducedFrames", "RepairChange", "RepairResult",
    "SampleInfo", "Selection", "StepReport", "TopologySummary", "UnsolvableError", "UsageError", "VertexDeformer",
    "WriteResult",
    "__version__", "check", "compare", "cut", "deform", "drop", "edit", "estimated_memory", "merge", "methods", "operators",
    "picture", "quality", "read", "repair", "sample", "samples", "select", "self_intersections", "write",
]


def __getattr__(name: str) -> object:
    if name == "operators":  # SciPy takes a while to import
        import importlib

        return importlib.import_module("meshgraft.operators")
    raise AttributeError(f"module 'meshgraft' has no attribute {name!r}")
