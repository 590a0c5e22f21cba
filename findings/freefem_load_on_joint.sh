#!/usr/bin/env bash
# FreeFem++ 4.9 (Debian 4.11): a load on the end of two blocks acts on the joint between them, too.
#
# Expected: two squares of 1 m side by side, put together by `left + right`, are one block of 2 m whose
#     boundary is 6 m long; label 2, the right side of each, is its right end.
# Seen: the joint stays in the list of edges with label 2, so that label 2 is 2 m long and the boundary
#     7 m.  A flow of 1 per m that enters by label 2 raises the head by 3 m in place of 2 m, with twice
#     the discharge at the other end.  With other labels for the joint it is 2 m.  No message.
# Meaning: loads, flows and supports of a part act inside of the whole where the parts meet.  The field
#     looks smooth, with a kink that passes for one of the material.  Give the sides that meet a label
#     of their own (`label=` of `square`, or `change`), and compare the length of each label.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
if [[ "$(FreeFem++ -nw 2>&1 || true)" != *'version 4.9'* ]]; then
    echo 'needs FreeFem++ 4.9: apt-get install freefem++'
    exit 1
fi
cat > run.edp <<'EDP'
// Labels: 1 below, 2 right, 3 above, 4 left.
mesh left = square(4, 4);
mesh right = square(4, 4, [x + 1, y]);
int[int] names = [2, 20];
int[int] none = [2, 2];
mesh both = left + right;

func real head(int[int] joint) {
    mesh Th = change(left, refe=joint) + right;
    fespace Vh(Th, P1);
    Vh h, test;
    solve Flow(h, test) = int2d(Th)(dx(h)*dx(test) + dy(h)*dy(test)) - int1d(Th, 2)(test) + on(4, h=0);
    return h(2, 0.5);
}

mesh named = change(left, refe=names) + right;
cout << "RESULT " << int1d(both, 2)(1.) << " " << int1d(both)(1.) << " " << head(none) << " "
    << int1d(named, 2)(1.) << " " << head(names) << endl;
EDP
FreeFem++ -nw -v 0 run.edp > run.log
read -r _ end boundary rise one right <<< "$(grep RESULT run.log)"
echo "label 2 is $end m long, the boundary $boundary m; the head rises by $rise m"
echo "with another label for the joint label 2 is $one m long, the head rises by $right m"
awk -v a="$end" -v b="$boundary" -v c="$rise" -v d="$one" -v e="$right" '
    function far(found, seen) { return found < 0.999 * seen || found > 1.001 * seen }
    BEGIN { exit far(a, 2) || far(b, 7) || far(c, 3) || far(d, 1) || far(e, 2) }'
