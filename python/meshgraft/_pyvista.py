"""The accessor `mesh.meshgraft` of pyvista.PolyData. PyVista imports this module by the package's entry point."""

from __future__ import annotations

from typing import Any

import pyvista

import meshgraft as mg


class Accessor:
    """The package's functions on a PyVista mesh: mesh.meshgraft.deform(...)."""

    def __init__(self, mesh: Any) -> None:
        self._mesh = mesh

    def deform(self, **arguments: Any) -> Any:
        """Returns the mesh deformed; see meshgraft.deform."""
        return mg.deform(self._mesh, **arguments)

    def deformer(self, **arguments: Any) -> mg.Deformer[Any]:
        """Makes a deformer of the mesh; see meshgraft.Deformer."""
        return mg.Deformer(self._mesh, **arguments)

    def merge(self, source: Any, **arguments: Any) -> Any:
        """Returns the mesh with another grafted onto it; see meshgraft.merge."""
        return mg.merge(self._mesh, source, **arguments).mesh

    def drop(self, source: Any, at: Any, **arguments: Any) -> Any:
        """Returns the mesh with another dropped on it; see meshgraft.drop."""
        return mg.drop(self._mesh, source, at, **arguments).mesh

    def cut(self, **arguments: Any) -> Any:
        """Returns the mesh cut open; see meshgraft.cut."""
        return mg.cut(self._mesh, **arguments).mesh

    def repair(self, **options: Any) -> Any:
        """Returns the mesh repaired; see meshgraft.repair."""
        return mg.repair(self._mesh, **options).mesh

    def check(self) -> mg.Diagnostics:
        """Names the mesh's defects; see meshgraft.check."""
        return mg.check(self._mesh)

    def select(self, selection: mg.Selection) -> Any:
        """Returns the vertices of a selection."""
        return selection(self._mesh)


pyvista.register_dataset_accessor("meshgraft", pyvista.PolyData)(Accessor)
