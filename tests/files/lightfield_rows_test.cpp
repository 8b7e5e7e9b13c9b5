// SPDX-License-Identifier: Apache-2.0
// Proves that a light field that comes in rows makes the same file, byte for byte, as one that is
// whole, in whatever order and number the rows come. Not how much memory that takes: fit_test does.
#include "formats/files/lightfield_rows.h"

#include "tests/files/sample_lightfield.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace nearfield::test {
namespace {

// Rows of all images of an array [image][j][i].
std::vector<float> rows_of(const Slab& slab, const std::vector<float>& all, int first, int count) {
    std::vector<float> rows;
    const auto width = static_cast<std::size_t>(slab.texels.x);
    for (std::size_t image = 0; image < all.size() / slab.texel_count(); ++image)
        for (std::size_t at = static_cast<std::size_t>(first) * width;
             at < static_cast<std::size_t>(first + count) * width; ++at)
            rows.push_back(all[image * slab.texel_count() + at]);
    return rows;
}

void put_rows(const Slab& slab, int first, int count, LightFieldRows& rows) {
    rows.put(first, count, rows_of(slab, slab.coeffs, first, count),
             slab.sigma.empty() ? std::vector<float>{} : rows_of(slab, slab.sigma, first, count));
}

TEST(LightFieldRows, MakeTheSameFileAsAWholeLightField) {
    for (const int channels : {1, 3})
        for (const bool has_sigma : {false, true}) {
            LightField whole = sample_lightfield();
            // More images than are written side by side.
            whole.slabs = {sample_slab({{6, 5}, {5, 4}, channels, has_sigma})};
            Slab& slab = whole.slabs.front();
            for (const float factor : {0.5F, 2.0F}) {
                slab.replicates.push_back(slab.coeffs);
                for (float& coefficient : slab.replicates.back())
                    coefficient *= factor;
            }
            LightFieldRows rows(slab, {has_sigma, 2}, ".");
            for (int r = 0; r < 2; ++r)
                rows.put_replicate(
                    r, 0, 4, rows_of(slab, slab.replicates[static_cast<std::size_t>(r)], 0, 4));
            put_rows(slab, 3, 1, rows);
            put_rows(slab, 0, 2, rows);
            put_rows(slab, 2, 1, rows);
            write_lightfield(whole, {}, "whole.lightfield.exr");
            rows.write(whole, {}, "rows.lightfield.exr");
            EXPECT_EQ(read_bytes("rows.lightfield.exr"), read_bytes("whole.lightfield.exr"))
                << channels << " channels";
            const Slab image = rows.image(8);
            EXPECT_EQ(image.image_count(), 1);
            EXPECT_EQ(image.basis_center_m(0, 0), slab.basis_center_m(2, 1));
            for (std::size_t t = 0; t < slab.texel_count(); ++t) {
                const std::size_t from = slab.image_offset(channels - 1, 8) + t;
                const std::size_t to = image.image_offset(channels - 1, 0) + t;
                EXPECT_EQ(image.coeffs[to], slab.coeffs[from]);
                EXPECT_EQ(image.replicates[1][to], slab.replicates[1][from]);
                if (has_sigma) {
                    EXPECT_EQ(image.sigma[to], slab.sigma[from]);
                }
            }
        }
}

TEST(LightFieldRows, TakeWhatWasNotSeenForAsBrightAsAny) {
    Slab slab = sample_slab({{2, 2}, {5, 4}, 1, true});
    LightFieldRows rows(slab, {true, 0}, ".");
    const float brightest = *std::max_element(slab.coeffs.begin(), slab.coeffs.end());
    slab.sigma[slab.image_offset(0, 3) + 6] = std::numeric_limits<float>::infinity();
    put_rows(slab, 0, 4, rows);
    EXPECT_EQ(rows.image(3).sigma[6], brightest);
    EXPECT_EQ(rows.image(3).sigma[7], slab.sigma[slab.image_offset(0, 3) + 7]);
}

TEST(LightFieldRows, AreDarkWhereNoneWerePut) {
    const Slab slab = sample_slab({{2, 2}, {5, 4}, 1, true});
    LightFieldRows rows(slab, {true, 0}, ".");
    put_rows(slab, 1, 1, rows);
    const std::vector<float> image = rows.image(3).coeffs;
    EXPECT_EQ(image[0], 0.0F);
    EXPECT_EQ(image[5], slab.coeffs[slab.image_offset(0, 3) + 5]);
    EXPECT_EQ(image[19], 0.0F);
}

TEST(LightFieldRows, RefuseWhatTheFileMustNotHold) {
    Slab slab = sample_slab({{2, 2}, {5, 4}, 1, false});
    LightFieldRows rows(slab, {}, ".");
    const auto refused = [&](int first, int count, std::vector<float> values) {
        return message_of([&] { rows.put(first, count, values, {}); });
    };
    EXPECT_NE(refused(3, 2, std::vector<float>(40, 1.0F)), "");
    EXPECT_NE(refused(-1, 1, std::vector<float>(20, 1.0F)), "");
    EXPECT_NE(refused(0, 1, std::vector<float>(19, 1.0F)), "");
    for (const float bad :
         {-1.0F, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
        std::vector<float> values(20, 1.0F);
        values[13] = bad;
        EXPECT_NE(refused(0, 1, values).find("value 13"), std::string::npos);
    }
    EXPECT_NE(message_of([&] { rows.put_replicate(0, 0, 1, std::vector<float>(20)); }), "");
    EXPECT_NE(message_of([&] { const LightFieldRows none(slab, {}, "no/such/folder"); }), "");
    slab.delta_m = -1;
    EXPECT_NE(message_of([&] { const LightFieldRows none(slab, {}, "."); }), "");
}

}  // namespace
}  // namespace nearfield::test
