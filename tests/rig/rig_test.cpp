// SPDX-License-Identifier: Apache-2.0
// Proves that a rig's files give back what was written, bit for bit, and that slips in them are
// refused by name. It does not prove that a calibration is right.
#include "formats/files/error.h"
#include "formats/files/json_field.h"
#include "formats/files/read_file.h"
#include "tests/rig/small_rig.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>

namespace nearfield::rig {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kPath = "small.json";

std::string message_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "nothing was refused";
}

// Writes the small rig with a change in its text.
std::string refusal_with(const std::function<void(Json&)>& change) {
    write_rig(test::small_rig(), test::small_maps(), std::nullopt, kPath);
    Json document = parse_json(read_file(kPath), kPath);
    change(document);
    std::ofstream(kPath) << document.dump();
    return message_of([] { read_rig(kPath); });
}

TEST(Rig, GivesBackWhatWasWritten) {
    write_rig(test::small_rig(), test::small_maps(), std::nullopt, kPath);
    const std::string first = read_file(kPath);
    const Rig rig = read_rig(kPath);
    const Maps maps = read_maps(kPath);
    write_rig(rig, maps, std::nullopt, kPath);
    EXPECT_EQ(read_file(kPath), first);
    const Maps expected = test::small_maps();
    EXPECT_EQ(maps.black_dn, expected.black_dn);
    EXPECT_EQ(maps.dark_dn_per_s, expected.dark_dn_per_s);
    EXPECT_EQ(maps.room_dn_per_s, expected.room_dn_per_s);
    EXPECT_EQ(maps.response, expected.response);
    EXPECT_EQ(maps.response_sigma_rel, expected.response_sigma_rel);
    EXPECT_EQ(maps.is_bad, expected.is_bad);
    const Rig original = test::small_rig();
    EXPECT_EQ(rig.planes->position_m, original.planes->position_m);
    EXPECT_EQ(rig.planes->camera_from_slab.rotation, original.planes->camera_from_slab.rotation);
    EXPECT_EQ(rig.radiometry->rgb_from_raw, original.radiometry->rgb_from_raw);
    EXPECT_EQ(rig.radiometry->scale_lx_s_per_dn, original.radiometry->scale_lx_s_per_dn);
}

TEST(Rig, NamesWhatIsWrongInItsFile) {
    EXPECT_THAT(refusal_with([](Json& json) { json["nearfield_rig"] = 2; }),
                AllOf(HasSubstr("small.json"), HasSubstr("version 1 ... 1")));
    EXPECT_THAT(refusal_with([](Json& json) { json["lens"].erase("fx_px"); }),
                AllOf(HasSubstr("lens"), HasSubstr("fx_px")));
    EXPECT_THAT(refusal_with([](Json& json) { json["lens"]["model"] = "pinhole"; }),
                AllOf(HasSubstr("lens.model"), HasSubstr("brown5, brown8, fisheye")));
    EXPECT_THAT(refusal_with([](Json& json) { json["lens"]["model"] = "brown8"; }),
                AllOf(HasSubstr("lens.distortion"), HasSubstr("8 elements")));
    EXPECT_THAT(refusal_with([](Json& json) { json["planes"]["delta_mm"] = 200; }),
                AllOf(HasSubstr("planes"), HasSubstr("delta_mm")));
    EXPECT_THAT(refusal_with([](Json& json) { json["planes"]["delta_m"] = -0.2; }),
                HasSubstr("planes.delta_m"));
    EXPECT_THAT(refusal_with([](Json& json) { json["planes"]["position_m"].erase(0); }),
                AllOf(HasSubstr("planes.position_m"), HasSubstr("6 elements")));
    EXPECT_THAT(
        refusal_with([](Json& json) { json["planes"]["camera_from_slab"]["rotation"][0] = 0.1; }),
        HasSubstr("proper rotation"));
    EXPECT_THAT(refusal_with([](Json& json) { json["radiometry"]["gain_e_per_dn"] = "2.7"; }),
                AllOf(HasSubstr("radiometry.gain_e_per_dn"), HasSubstr("a finite number")));
    EXPECT_THAT(refusal_with([](Json& json) { json["radiometry"]["linear"]["x"][1] = 5000; }),
                HasSubstr("ascending"));
    EXPECT_THAT(refusal_with([](Json& json) { json["covariance"].erase(0); }),
                HasSubstr("covariance"));
}

TEST(Rig, MayBeALensAlone) {
    Rig lens_alone;
    lens_alone.lens = test::small_rig().lens;
    write_rig(lens_alone, {}, std::nullopt, "lens.json");
    const Rig rig = read_rig("lens.json");
    EXPECT_EQ(rig.lens->fx_px, lens_alone.lens->fx_px);
    EXPECT_FALSE(rig.planes || rig.radiometry);
    EXPECT_FALSE(std::filesystem::exists("lens.maps.exr"));
    EXPECT_THAT(message_of([] { read_maps("lens.json"); }), HasSubstr("maps"));
    EXPECT_THAT(message_of([] { write_rig({}, {}, std::nullopt, "nothing.json"); }),
                HasSubstr("a lens or radiometry"));
}

TEST(Rig, RefusesMapsThatAreNotItsOwn) {
    write_rig(test::small_rig(), test::small_maps(), std::nullopt, kPath);
    Maps other = test::small_maps();
    other.response[3] = 0.5F;
    write_rig(test::small_rig(), other, std::nullopt, "other.json");
    std::filesystem::copy_file("other.maps.exr", "small.maps.exr",
                               std::filesystem::copy_options::overwrite_existing);
    EXPECT_THAT(message_of([] { read_maps(kPath); }), HasSubstr("small.maps.exr"));
    std::filesystem::remove("small.maps.exr");
    EXPECT_THAT(message_of([] { read_maps(kPath); }), HasSubstr("small.maps.exr"));
}

TEST(Rig, RefusesToWriteNonsense) {
    Maps maps = test::small_maps();
    maps.dark_dn_per_s[2] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THAT(message_of([&] { write_rig(test::small_rig(), maps, std::nullopt, "bad.json"); }),
                AllOf(HasSubstr("dark_dn_per_s"), HasSubstr("nan")));
    maps = test::small_maps();
    maps.size_px = {4, 6};
    EXPECT_THAT(message_of([&] { write_rig(test::small_rig(), maps, std::nullopt, "bad.json"); }),
                HasSubstr("6 x 4 px"));
    EXPECT_FALSE(std::filesystem::exists("bad.json"));
}

}  // namespace
}  // namespace nearfield::rig
