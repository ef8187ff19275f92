#!/bin/bash
# CalculiX 2.20: no contact on the part of an axisymmetric master face that is next to the axis.
#
# A rigid flat (one CAX8R element, r = 0 to 2) presses a disc of eight CAX8R elements (r = 0 to 1) by
# 0.001. Guess: the whole top of the disc moves by 0.001. Seen: near the axis the top
# moves by less than half, because no contact acts there.
# If the flat begins with a face of the width 0.01 at the axis, all nodes beyond it move by 0.001.
#
# Debian bookworm, as root: installs calculix-ccx=2.20-1. Exits with 1 if the behaviour has changed.
set -eu
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
cd "$folder"
command -v ccx > /dev/null || apt-get install -y -qq calculix-ccx=2.20-1 > /dev/null
ccx -v | grep Version

cat > make.py << 'PYTHON'
import sys

edges = [0.0, 2.0] if sys.argv[1] == "one" else [0.0, 0.01, 2.0]
nodes, elements = [], []


def row(corners, bottom, top):
    """A row of eight-node elements between two heights; return the numbers of the nodes."""
    r = sorted([*corners, *(0.5 * (a + b) for a, b in zip(corners, corners[1:]))])
    number = {}
    for i, x in enumerate(r):
        for j, z in enumerate((bottom, 0.5 * (bottom + top), top)):
            if i % 2 and j == 1:
                continue
            nodes.append((x, z))
            number[i, j] = len(nodes)
    for i in range(0, len(r) - 1, 2):
        ring = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
        elements.append([number[i + a, b] for a, b in ring])
    return number


disc = row([k / 8 for k in range(9)], -1.0, 0.0)
flat = row(edges, 0.0, 1.0)


def lines(numbers):
    return "".join(f"{n},\n" for n in numbers)


text = "*NODE, NSET=ALL\n" + "".join(f"{n}, {r}, {z}\n" for n, (r, z) in enumerate(nodes, 1))
text += "*ELEMENT, TYPE=CAX8R, ELSET=EALL\n"
text += "".join(f"{n}, {', '.join(map(str, e))}\n" for n, e in enumerate(elements, 1))
text += f"*NSET, NSET=FLAT\n{lines(flat.values())}"
text += f"*NSET, NSET=TOP\n{lines(n for (i, j), n in disc.items() if j == 2)}"
text += f"*NSET, NSET=BASE\n{lines(n for (i, j), n in disc.items() if j == 0)}"
text += f"*NSET, NSET=AXIS\n{lines(n for (i, j), n in disc.items() if i == 0)}"
text += "*SURFACE, NAME=SLAVE\n" + "".join(f"{k}, S3\n" for k in range(1, 9))
text += "*SURFACE, NAME=MASTER\n" + "".join(f"{k}, S1\n" for k in range(9, 8 + len(edges)))
text += """*MATERIAL, NAME=M
*ELASTIC
1., 0.
*SOLID SECTION, ELSET=EALL, MATERIAL=M
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
1000.
*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE
SLAVE, MASTER
*BOUNDARY
AXIS, 1, 1
BASE, 2, 2
*STEP
*STATIC
1., 1.
*BOUNDARY
FLAT, 1, 1
FLAT, 2, 2, -0.001
*NODE PRINT, NSET=TOP
U
*END STEP
"""
open("disc.inp", "w").write(text)
PYTHON

motion() {
    python3 make.py "$1"
    OMP_NUM_THREADS=1 ccx disc > log
    # The last increment; r of the 17 nodes rises with their number.
    awk 'NF == 4 { print -$3 / 0.001 }' disc.dat | tail -n 17 | tr '\n' ' '
}
echo "motion of the top over that of the flat, from r = 0 to 1"
one=$(motion one)
small=$(motion small)
echo "one face:             $one"
echo "small face at r = 0:  $small"
python3 - "$one" "$small" << 'PYTHON'
import sys

one, small = ([float(x) for x in text.split()] for text in sys.argv[1:])
sys.exit(not (one[0] < 0.9 and one[-1] > 0.95 and min(small[2:]) > 0.95))
PYTHON
