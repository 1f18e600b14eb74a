"""Works out the bound of a certificate (standard input, JSON) anew, over all links, and compares it with what it says.

The cheapest tree over the paths by Prim's algorithm, whole numbers but for one square root; see docs/ordering-bounds.md.
"""
import json
import math
import sys

certificate = json.load(sys.stdin)
path, points, nodes = certificate["path"], certificate["points"], certificate["nodes"]
closed, cuts = certificate["closed"], certificate["cuts"]
paths, terminals = len(closed), len(path)
of = [set() for _ in range(terminals + 1)]  # cuts of each terminal; the last is the start
for number, cut in enumerate(cuts):
    for terminal in cut["members"]:
        of[terminal].add(number)
tie = {(t["terminal"], t["neighbour"]): t["price"] for t in certificate["ties"]}
price = [cut["price"] for cut in cuts]
weight = [(nodes + [0])[t] - sum(price[c] for c in of[t]) for t in range(terminals + 1)]
places = [(x, y, t) for t in range(terminals) for x, y in points[t]]


def length(a, b):
    """Sixteenths of a grid unit, rounded down."""
    squared = (a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2
    return math.isqrt(256 * squared)


def link(a, b):
    """What a link between two places costs with all that it pays."""
    s, t = a[2], b[2]
    both = 2 * sum(price[c] for c in of[s] & of[t])
    return length(a, b) + weight[s] + weight[t] + both + tie.get((s, path[t]), 0) + tie.get((t, path[s]), 0)


def end(side):
    """The cheapest link into the walk (0) or out of it (1)."""
    at, best = certificate["ends"][side], None
    for place in places:
        t = place[2]
        cost = (length(at, place) if at else 0) + weight[t] + tie.get((t, paths + side), 0)
        if side == 0:
            cost += weight[terminals] + 2 * sum(price[c] for c in of[t] & of[terminals])
        best = cost if best is None else min(best, cost)
    return best


tree, joined, cheapest = 0, {0}, {place: math.inf for place in places}
newest = 0
while len(joined) < paths:
    for place in places:
        if path[place[2]] not in joined:
            links = (link(other, place) for other in places if path[other[2]] == newest)
            cheapest[place] = min(cheapest[place], *links)
    nearest = min((place for place in places if path[place[2]] not in joined), key=cheapest.get)
    tree, newest = tree + cheapest[nearest], path[nearest[2]]
    joined.add(newest)

given_back = sum(cut["least"] * cut["price"] for cut in cuts if cut["guard"] is None)
for p in range(paths):
    own = [t for t in range(terminals) if path[t] == p]
    if not closed[p]:
        given_back -= sum(nodes[t] for t in own)
        continue
    ties = {t: sum(cost for (at, _), cost in tie.items() if at == t) for t in own}
    guards = {t: sum(cuts[c]["least"] * price[c] for c in of[t] if cuts[c]["guard"] == p) for t in own}
    given_back -= max(2 * nodes[t] + ties[t] - guards[t] for t in own)

bound = tree + end(0) + end(1) + given_back
# The program takes a little more off each link when it rounds.
right = certificate["bound"] <= bound <= certificate["bound"] + 2 * (paths + 1)
print(f"bound {bound / 1.6e6:.6f} mm, certificate {certificate['bound'] / 1.6e6:.6f} mm: {'the same' if right else 'WRONG'}")
sys.exit(0 if right else 1)
