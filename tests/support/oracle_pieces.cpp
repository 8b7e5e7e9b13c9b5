// SPDX-License-Identifier: Apache-2.0
#include "tests/support/oracle_pieces.h"

namespace nearfield::support {
namespace {

void append_pieces(std::vector<Piece>& pieces,
                   const Axis& axis,
                   const AxisMap& map,
                   const Refinement& refinement,
                   Piece piece) {
    if (!(piece.high_m > piece.low_m))
        return;
    const double middle_m = 0.5 * (piece.low_m + piece.high_m);
    const double beside_m =
        std::max({0.0, piece.low_m - refinement.center_m, refinement.center_m - piece.high_m});
    if (piece.high_m - piece.low_m > 0.5 * std::hypot(beside_m, refinement.height_m)) {
        Piece left = piece, right = piece;
        left.high_m = right.low_m = middle_m;
        append_pieces(pieces, axis, map, refinement, left);
        append_pieces(pieces, axis, map, refinement, right);
        return;
    }
    piece.texel = axis.texel_at(map.s_m(middle_m));
    if (piece.texel >= 0 && piece.texel < axis.texel_count)
        pieces.push_back(piece);
}

}  // namespace

Axis axis_of(const Slab& slab, int d) {
    return {slab.grid[d],    slab.texels[d],  slab.basis_center_m(0, 0)[d],
            slab.pitch_m[d], slab.s_min_m[d], slab.texel_m()[d],
            &slab.profile};
}

std::vector<Piece> cut_axis(const Axis& axis,
                            const AxisMap& map,
                            const Refinement& refinement,
                            const GaussRule& rule) {
    std::vector<Piece> pieces;
    for (int k = 0; k < axis.cell_count(); ++k) {
        std::vector<double> cuts_m = {axis.edge_m(k), axis.edge_m(k + 1)};
        const double low_m = cuts_m[0], high_m = cuts_m[1];
        // Texels fall along U where the receiver is between the planes.
        const int at_low = axis.texel_at(map.s_m(low_m)), at_high = axis.texel_at(map.s_m(high_m));
        const int first = std::min(at_low, at_high), last = std::max(at_low, at_high);
        for (int i = std::max(first, 0); i <= std::min(last + 1, axis.texel_count); ++i) {
            const double u_m = map.u_m(axis.s_min_m + i * axis.texel_m);
            if (u_m > low_m && u_m < high_m)
                cuts_m.push_back(u_m);
        }
        std::sort(cuts_m.begin(), cuts_m.end());
        for (std::size_t c = 0; c + 1 < cuts_m.size(); ++c)
            append_pieces(pieces, axis, map, refinement,
                          {cuts_m[c], cuts_m[c + 1], k, 0, {}, {}, {}});
    }
    for (Piece& piece : pieces) {
        for (std::size_t q = 0; q < rule.node.size(); ++q) {
            piece.u_m.push_back(piece.low_m + (piece.high_m - piece.low_m) * rule.node[q]);
            piece.weight_m.push_back((piece.high_m - piece.low_m) * rule.weight[q]);
        }
        for (int b = piece.cell - axis.profile_cells() + 1; b <= piece.cell; ++b)
            for (const double u_m : piece.u_m)
                piece.phi.push_back(axis.phi(b, piece.cell, u_m));
    }
    return pieces;
}

}  // namespace nearfield::support
