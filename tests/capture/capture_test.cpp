// SPDX-License-Identifier: Apache-2.0
#include "formats/capture/capture.h"

#include "formats/files/atomic_file.h"
#include "formats/files/error.h"
#include "formats/files/read_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

namespace nearfield::capture {
namespace {

class CaptureFolder : public testing::Test {
  protected:
    void SetUp() override { std::filesystem::remove_all(folder_); }

    static CaptureHeader header() {
        CaptureHeader header;
        header.plan.emplace();
        header.plan->grid = {2, 1};
        header.plan->pitch_m = {0.016, 0.016};
        header.plan->basis = "bspline";
        header.plan->darks = 1;
        header.plan->bracket.exposures_us = {100, 400};
        header.provenance.program = program_version();
        return header;
    }

    static Frame frame(int value) {
        Frame frame;
        frame.size_px = {8, 8};
        frame.bits = 12;
        frame.values.assign(64, static_cast<std::uint16_t>(value));
        return frame;
    }

    static FrameRecord record(const Shot& shot) {
        FrameRecord record;
        record.shot = shot;
        record.pixel_format = "Mono12";
        record.exposure_us = shot.exposure_us;
        record.time_us = 1234567890123;
        record.camera_time_ns = 42;
        record.temperature_c = 31.5;
        return record;
    }

    // All but the last frame.
    void write_most() {
        CaptureWriter writer = CaptureWriter::create(folder_, header());
        writer.add(SessionRecord{1, "2026-01-01T00:00:00Z", "nearfield", "v", "m", "s", 0});
        const std::vector<Shot> shots = shots_of(*header().plan);
        for (std::size_t k = 0; k + 1 < shots.size(); ++k)
            writer.add(frame(static_cast<int>(k)), record(shots[k]));
    }

    const std::string folder_ = "a_capture";
    const std::string log_ = folder_ + "/log.jsonl";
};

TEST_F(CaptureFolder, TellsWhatWasWritten) {
    write_most();
    const Capture capture = read_capture(folder_);
    EXPECT_EQ(json_of(*capture.header.plan), json_of(*header().plan));
    EXPECT_EQ(capture.sessions.size(), 1U);
    ASSERT_EQ(capture.frames.size(), 5U);
    const FrameRecord& record = capture.frames.at(3);
    EXPECT_EQ(record.shot.position, glm::ivec2(0, 0));
    EXPECT_EQ(record.time_us, 1234567890123);
    EXPECT_EQ(record.temperature_c, 31.5);
    EXPECT_EQ(record.reading_lx, std::nullopt);
    EXPECT_EQ(read_frame(folder_, record).values, frame(3).values);
    EXPECT_TRUE(damaged_frames(folder_, capture, {}).empty());
    ASSERT_EQ(missing_shots(capture).size(), 1U);
    EXPECT_EQ(missing_shots(capture).front().number, 5);
}

// The log cut at every byte: what is read is always a beginning of what was written, and a writer
// goes on from there.
TEST_F(CaptureFolder, SurvivesATornLog) {
    write_most();
    const std::string whole = read_file(log_);
    for (std::size_t size = 0; size < whole.size(); size += 7) {
        write_file(whole.substr(0, size), log_);
        const Capture torn = read_capture(folder_);
        EXPECT_EQ(torn.has_torn_end, size > 0 && whole[size - 1] != '\n');
        {
            CaptureWriter writer = CaptureWriter::reopen(folder_);
            writer.add(EventRecord{2, 0, "went on", ""});
        }
        const Capture after = read_capture(folder_);
        EXPECT_FALSE(after.has_torn_end);
        EXPECT_EQ(after.frames.size(), torn.frames.size());
        EXPECT_EQ(after.events.size(), 1U);
    }
}

TEST_F(CaptureFolder, FindsDamagedAndMissingFrames) {
    write_most();
    const Capture capture = read_capture(folder_);
    const std::string first = folder_ + "/" + capture.frames.at(1).file;
    std::string bytes = read_file(first);
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    write_file(bytes, first);
    std::filesystem::remove(folder_ + "/" + capture.frames.at(4).file);
    EXPECT_EQ(damaged_frames(folder_, capture, {}), (std::vector<int>{1, 4}));
    EXPECT_THROW(read_frame(folder_, capture.frames.at(1)), Error);
    EXPECT_THROW(read_frame(folder_, capture.frames.at(4)), Error);
}

TEST_F(CaptureFolder, TakesRejectedFramesAgain) {
    write_most();
    const std::vector<Shot> shots = shots_of(*header().plan);
    {
        CaptureWriter writer = CaptureWriter::reopen(folder_);
        writer.add(RejectRecord{{2, 3}, "the lamp drifts"});
    }
    EXPECT_EQ(missing_shots(read_capture(folder_)).size(), 3U);
    {
        CaptureWriter writer = CaptureWriter::reopen(folder_);
        writer.add(frame(77), record(shots[2]));
    }
    const Capture capture = read_capture(folder_);
    EXPECT_EQ(missing_shots(capture).size(), 2U);
    EXPECT_EQ(read_frame(folder_, capture.frames.at(2)).values.front(), 77);
}

TEST_F(CaptureFolder, HasOneWriter) {
    const CaptureWriter writer = CaptureWriter::create(folder_, header());
    EXPECT_THROW(CaptureWriter::reopen(folder_), Error);
    EXPECT_THROW(CaptureWriter::create(folder_, header()), Error);
}

TEST_F(CaptureFolder, IsNotMadeWhereFilesAre) {
    std::filesystem::create_directory(folder_);
    write_file("x", folder_ + "/notes.txt");
    EXPECT_THROW(CaptureWriter::create(folder_, header()), Error);
    EXPECT_FALSE(std::filesystem::exists(folder_ + "/frames"));
    EXPECT_THROW(read_capture(folder_), Error);
}

TEST_F(CaptureFolder, RefusesLinesThatAreNotItsOwn) {
    write_most();
    const std::string whole = read_file(log_);
    const auto complaint = [&](const std::string& line) -> std::string {
        write_file(whole + line + "\n", log_);
        try {
            read_capture(folder_);
        } catch (const Error& error) {
            return error.what();
        }
        return "accepted";
    };
    EXPECT_THAT(complaint("nonsense"), testing::HasSubstr("log.jsonl, line 7"));
    EXPECT_THAT(complaint("{\"record\":\"frames\"}"), testing::HasSubstr("'frames'"));
    std::string escape = whole.substr(whole.rfind("{\"record\":\"frame\""));
    escape.pop_back();
    escape.replace(escape.find("frames/"), 7, "../../../");
    EXPECT_THAT(complaint(escape), testing::HasSubstr("below the capture's folder"));
}

}  // namespace
}  // namespace nearfield::capture
