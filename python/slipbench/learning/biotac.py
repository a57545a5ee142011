"""Tactile images and the tactile graph of the BioTac SP [zapata2019].

Recipes and the paper's studies use them.
"""

# PyTorch's layers and operators are typed only in part, depending on the release.
# mypy: disable-error-code="no-untyped-call,no-any-return,attr-defined,unused-ignore"

from __future__ import annotations

import torch
from torch import Tensor

ELECTRODES = 24  # E1 is number 0

# Edges of the hand-drawn graph.
EDGES = (
    (0, 1),
    (1, 20),
    (2, 3),
    (3, 4),
    (3, 21),
    (3, 23),
    (4, 6),
    (4, 7),
    (4, 23),
    (5, 6),
    (6, 7),
    (6, 8),
    (7, 8),
    (7, 17),
    (8, 9),
    (10, 11),
    (11, 20),
    (12, 13),
    (13, 14),
    (13, 22),
    (13, 23),
    (14, 16),
    (14, 17),
    (14, 23),
    (15, 16),
    (16, 17),
    (16, 18),
    (17, 18),
    (18, 19),
    (20, 21),
    (20, 22),
    (21, 22),
    (21, 23),
    (22, 23),
)

Layout = tuple[tuple[int, int], tuple[tuple[int, int], ...]]

# The images of the paper's Fig. 3: rows and columns, then the row and column of each electrode, as
# in the authors' code (yayaneath/biotac-sp-images); of its two with 6 x 5, the one with E2 in the
# second row.
IMAGES: dict[str, Layout] = {
    "D1": (
        (12, 11),
        (
            (0, 1),
            (1, 2),
            (4, 0),
            (5, 1),
            (6, 3),
            (7, 0),
            (8, 1),
            (9, 4),
            (10, 2),
            (11, 1),
            (0, 9),
            (1, 8),
            (4, 10),
            (5, 9),
            (6, 7),
            (7, 10),
            (8, 9),
            (9, 6),
            (10, 8),
            (11, 9),
            (2, 5),
            (3, 4),
            (3, 6),
            (5, 5),
        ),
    ),
    "D2": (
        (6, 5),
        (
            (0, 4),
            (1, 4),
            (2, 4),
            (2, 3),
            (3, 3),
            (3, 4),
            (4, 4),
            (4, 3),
            (5, 3),
            (5, 4),
            (0, 0),
            (1, 0),
            (2, 0),
            (2, 1),
            (3, 1),
            (3, 0),
            (4, 0),
            (4, 1),
            (5, 1),
            (5, 0),
            (0, 2),
            (1, 3),
            (1, 1),
            (2, 2),
        ),
    ),
    "D3": (
        (4, 7),
        (
            (0, 6),
            (0, 5),
            (1, 6),
            (1, 5),
            (2, 4),
            (2, 6),
            (2, 5),
            (3, 4),
            (3, 5),
            (3, 6),
            (0, 0),
            (0, 1),
            (1, 0),
            (1, 1),
            (2, 2),
            (2, 0),
            (2, 1),
            (3, 2),
            (3, 1),
            (3, 0),
            (0, 3),
            (1, 4),
            (1, 2),
            (2, 3),
        ),
    ),
}


def pixels_of(layout: Layout) -> list[list[int]]:
    """Electrodes averaged by each pixel, row by row.

    Its own electrode, else the three nearest in the image.
    """
    (rows, columns), places = layout
    pixels = []
    for row in range(rows):
        for column in range(columns):
            distance = [(r - row) ** 2 + (c - column) ** 2 for r, c in places]
            nearest = sorted(range(ELECTRODES), key=distance.__getitem__)
            pixels.append(nearest[: 1 if distance[nearest[0]] == 0 else 3])
    return pixels


def normalised_adjacency(nodes: int, edges: tuple[tuple[int, int], ...]) -> Tensor:
    """D^-1/2 (A + 1) D^-1/2 of undirected edges; every node is its own neighbour.

    [nodes, nodes]
    """
    adjacency = torch.eye(nodes, dtype=torch.float64)
    for a, b in edges:
        adjacency[a, b] = adjacency[b, a] = 1.0
    scale = adjacency.sum(1).rsqrt()
    return (scale[:, None] * adjacency * scale).float()


def drawn_graph() -> Tensor:
    """The normalised adjacency of the hand-drawn graph.

    [24, 24]
    """
    return normalised_adjacency(ELECTRODES, EDGES)
