"""By how much the heap is moved in each start of the microscopic model.

Where parts meet a plate, and in which order, is chance: one start says little. n starts move the heap within a
square of one spacing. Both coordinates take the same n evenly spread values around 0, the second one in the order of
the golden section, so that they cover the square evenly and their mean is the nominal heap, which the macroscopic
model starts from.
"""

GOLDEN = 0.6180339887498949


def shifts(n):
    """n pairs of shifts along and across the belt, in spacings."""
    order = sorted(range(n), key=lambda k: k * GOLDEN % 1.0)
    return [((k + 0.5) / n - 0.5, (order[k] + 0.5) / n - 0.5) for k in range(n)]
