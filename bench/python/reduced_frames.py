#!/usr/bin/env python3
"""Compares reduced frames with exact evaluations.

    reduced_frames.py [--centres N…]

Prints a Markdown table: the largest distance of a frame from the exact evaluation, relative to the largest displacement, in
per cent. One end of each model is held and the other one is moved; around the disc, the border of the sheet is held. An
asterisk marks poses in which the exact evaluation has not settled within its steps.
"""

import argparse

import numpy as np

import meshgraft as mg

MODELS = [("bar", 96), ("cylinder", 70), ("octopus", 40), ("cactus", 40), ("dinosaur", 60)]
# Name: rotation about the length of the model (or the normal of the sheet), about an axis across it, and the rest.
POSES = {"move": {}, "bend 45°": {"bend": 45}, "bend 90°": {"bend": 90}, "bend 120°": {"bend": 120},
         "twist 45°": {"twist": 45}, "twist 90°": {"twist": 90}, "twist 180°": {"twist": 180}, "twist 360°": {"twist": 360},
         "twist 720°": {"twist": 720}, "turn, grow, move": {"bend": 60, "scale": 1.3, "moves": True}}


def ends_of(mesh):
    """The vertices held and moved, the axis of the model's length, and that of bends."""
    points = mesh.vertices
    length = int(np.ptp(points, axis=0).argmax())
    place = (points[:, length] - points[:, length].min()) / np.ptp(points[:, length])
    return place <= 0.2, place >= 0.88, length, (length + 1) % 3


def disc_of(side, relief, centre=(0, 0)):
    """A square sheet with bumps, 1 across, and the edit of a disc of radius 0.1 in it."""
    x, y = np.meshgrid(np.linspace(-0.5, 0.5, side), np.linspace(-0.5, 0.5, side))
    z = relief * (np.sin(9 * x) * np.cos(7 * y) + 0.4 * np.sin(23 * x + 1) * np.sin(19 * y))
    points = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    number = np.arange(side * side).reshape(side, side)
    a, b, c, d = number[:-1, :-1].ravel(), number[:-1, 1:].ravel(), number[1:, 1:].ravel(), number[1:, :-1].ravel()
    mesh = mg.Mesh(points, np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])]))
    return mesh, (np.abs(points[:, :2]).max(axis=1) > 0.495, np.hypot(points[:, 0] - centre[0], points[:, 1] - centre[1]) < 0.1,
                  2, 0)


def pose_of(parts, points, length, across):
    """The pose of some parts, about the middle of the moved points."""
    axes = np.eye(3)
    size = np.ptp(points, axis=0).max()
    moves = "moves" in parts or not parts
    given = {"pivot": points.mean(axis=0), "translate": 0.5 * size * axes[length] if moves else (0, 0, 0)}
    for name, axis in (("bend", across), ("twist", length)):
        if name in parts:
            given["rotate"] = (axes[axis], parts[name])
    if "scale" in parts:
        given["scale"] = parts["scale"]
    return mg.Pose(**given)


def errors_of(mesh, ends, all_centres):
    """For each pose the errors by number of centres, and whether the exact evaluation has settled."""
    held, moved, length, across = ends
    points = mesh.vertices
    deformer = mg.Deformer(mesh, handles={"moved": moved}, fixed=held)
    frames = [deformer.reduced_frames(centres=centres) for centres in all_centres]
    for parts in POSES.values():
        pose = pose_of(parts, points[moved], length, across)
        exact, report = deformer.positions_and_report(moved=pose)
        largest = np.linalg.norm(exact - points, axis=1).max()
        errors = [np.linalg.norm(one.frame(moved=pose) - exact, axis=1).max() / largest for one in frames]
        yield errors, report.last_rotation_change < 1e-4


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--centres", type=int, nargs="+", default=[128, 64], metavar="N")
    centres = parser.parse_args().centres
    edits = [(name, mesh, ends_of(mesh)) for name, resolution in MODELS
             for mesh in [mg.sample(name, resolution=resolution)]]
    for name, *of_disc in (("sheet with a disc", 0.0025), ("bumpy sheet with a disc", 0.05),
                           ("sheet with a disc at (0.2, 0.1)", 0.0025, (0.2, 0.1))):
        edits.append((name, *disc_of(100, *of_disc)))
    print(f"| K = {centres[0]} {''.join(f'({k})' for k in centres[1:])} | {' | '.join(POSES)} |")
    print("|---|" + "---|" * len(POSES))
    for name, mesh, ends in edits:
        cells = []
        for errors, has_settled in errors_of(mesh, ends, centres):
            first, *others = (f"{100 * error:.{1 if error < 0.1 else 0}f}{'' if has_settled else '*'}" for error in errors)
            cells.append(first + "".join(f" ({other})" for other in others))
        print(f"| {name}, {len(mesh.vertices):,} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
