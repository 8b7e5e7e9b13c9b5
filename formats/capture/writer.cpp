// SPDX-License-Identifier: Apache-2.0
#include "formats/capture/capture.h"
#include "formats/capture/header.h"
#include "formats/files/atomic_file.h"
#include "formats/files/error.h"
#include "formats/files/read_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <utility>

namespace nearfield::capture {
namespace {

std::string log_of(const std::string& folder) {
    return folder + "/log.jsonl";
}

void make_folder(const std::string& path) {
    std::error_code failed;
    std::filesystem::create_directories(path, failed);
    if (failed)
        throw Error{"cannot create folder", path, "", failed.message()};
}

// Cuts off what follows the last line end: a line that a crash left unfinished.
void cut_torn_end(int log, const std::string& path) {
    const std::string text = read_file(path);
    const std::size_t end = text.rfind('\n');
    const std::size_t whole = end == std::string::npos ? 0 : end + 1;
    if (whole < text.size() && ftruncate(log, static_cast<off_t>(whole)) != 0)
        throw Error{"cannot write file", path, "", system_error()};
}

}  // namespace

CaptureWriter::CaptureWriter(std::string folder) : folder_(std::move(folder)) {
    const std::string path = log_of(folder_);
    log_ = open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (log_ < 0)
        throw Error{"cannot write file", path, "", system_error()};
    if (flock(log_, LOCK_EX | LOCK_NB) != 0) {
        close(std::exchange(log_, -1));
        throw Error{"cannot write capture", folder_, "nobody else writing it",
                    "another nearfield does"};
    }
}

CaptureWriter::CaptureWriter(CaptureWriter&& other) noexcept
    : folder_(std::move(other.folder_)), log_(std::exchange(other.log_, -1)) {}

CaptureWriter::~CaptureWriter() {
    if (log_ >= 0)
        close(log_);
}

CaptureWriter CaptureWriter::create(const std::string& folder, const CaptureHeader& header) {
    std::error_code failed;
    if (holds_capture(folder))
        throw Error{"cannot start capture", folder, "a new or empty folder, or --resume",
                    "a capture"};
    if (std::filesystem::exists(folder, failed) && !std::filesystem::is_empty(folder, failed))
        throw Error{
            "cannot start capture", folder, "a new or empty folder",
            std::filesystem::is_directory(folder, failed) ? "a folder with files in it" : "a file"};
    make_folder(folder + "/frames");
    CaptureWriter writer(folder);
    // Last: a folder without it is no capture, so that a crash before leaves nothing to go on with.
    write_file(header_text(header), folder + "/capture.json");
    return writer;
}

CaptureWriter CaptureWriter::reopen(const std::string& folder) {
    CaptureWriter writer(folder);
    cut_torn_end(writer.log_, log_of(folder));
    make_folder(folder + "/frames");
    return writer;
}

FrameRecord CaptureWriter::add(const Frame& frame, FrameRecord record) {
    const std::string bytes = encode_frame(frame);
    const FrameLevels levels = levels_of(frame);
    record.file = fmt::format("frames/{:06}_{}.png", record.shot.number, name_of(record.shot));
    record.xxh128 = hash_bytes(bytes);
    record.size_px = frame.size_px;
    record.channels = frame.channels;
    record.bits = frame.bits;
    record.mean_dn = levels.mean_dn;
    record.share_saturated = levels.share_saturated;
    write_file(bytes, folder_ + "/" + record.file);
    append(json_of(record));
    return record;
}

void CaptureWriter::add(const SessionRecord& session) {
    append(json_of(session));
}

void CaptureWriter::add(const EventRecord& event) {
    append(json_of(event));
}

void CaptureWriter::add(const RejectRecord& reject) {
    append(json_of(reject));
}

// A line that could be written in part only (disk full) is taken back.
void CaptureWriter::append(const Json& line) {
    const std::string text = json_text(line) + "\n";
    const off_t end = lseek(log_, 0, SEEK_END);
    ssize_t written = 0;
    do
        written = write(log_, text.data(), text.size());
    while (written < 0 && errno == EINTR);
    if (written == static_cast<ssize_t>(text.size()))
        return;
    const std::string reason = written < 0 ? system_error() : "no space left on device";
    if (written > 0 && ftruncate(log_, end) != 0)
        throw Error{"cannot write file", log_of(folder_), "",
                    "a line is cut off: " + system_error()};
    throw Error{"cannot write file", log_of(folder_), "", reason};
}

}  // namespace nearfield::capture
