#include "libslam/rawlogs/rawlog_stream.h"

#include <mrpt/maps/registerAllClasses.h>
#include <mrpt/obs/CAction.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CObservation.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPosePDF.h>
#include <mrpt/rtti/CObject.h>
#include <mrpt/serialization/CArchive.h>
#include <mrpt/serialization/CSerializable.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <new>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/files/memory_guard.h"

namespace slam::rawlogs {
namespace {

[[noreturn]] void notOffered(const char* what) {
  throw core::ContractError(std::string("rawlog stream: ") + what + " is not offered");
}

struct ObjectHeader {
  std::string class_name;  ///< "" when no object starts here
  bool is_cut = false;     ///< the bytes end inside what may be a header
};

/// The start of a serialized MRPT object, in one of two layouts: since MRPT 0.5.5 one byte with bit 7 set and
/// the length of the class name, before that the length in four bytes, least first.
ObjectHeader headerAt(const std::string& bytes) {
  if (bytes.empty()) return {"", true};
  const auto first = static_cast<unsigned char>(bytes[0]);
  const bool old_layout = (first & 0x80U) == 0;
  const size_t length = first & 0x7FU, start = old_layout ? 4 : 1;
  const auto is_zero = [](char c) { return c == 0; };
  const auto is_letter = [](char c) { return c > 32 && c < 127; };
  const auto length_end = bytes.begin() + static_cast<std::ptrdiff_t>(std::min(start, bytes.size()));
  if (length == 0 || !std::all_of(bytes.begin() + 1, length_end, is_zero)) return {};
  const std::string name = bytes.substr(std::min(start, bytes.size()), length);
  if (!std::all_of(name.begin(), name.end(), is_letter)) return {};
  return name.size() < length ? ObjectHeader{"", true} : ObjectHeader{name, false};
}

/// How many log entries begin in the content of a file, up to where it cannot be unpacked, without parsing
/// them: by the names in their headers. Observations count only in a log without frames; in frames they are
/// parts.
class EntryEstimate {
 public:
  void take(std::string_view content) {
    for (Name* name : {&actions_, &frames_, &observations_}) name->take(content);
  }
  std::uint64_t count() const {
    const std::uint64_t in_frames = actions_.found + frames_.found;
    return in_frames > 0 ? in_frames : observations_.found;
  }

 private:
  struct Name {
    std::string_view text;
    std::uint64_t found = 0;
    std::string tail = {};  ///< of the content so far, for a name across two pieces
    void take(std::string_view content) {
      const std::string joined = tail + std::string(content);
      for (size_t at = joined.find(text); at != std::string::npos; at = joined.find(text, at + text.size()))
        ++found;
      tail = joined.substr(joined.size() - std::min(joined.size(), text.size() - 1));
    }
  };
  Name actions_{"mrpt::obs::CActionCollection"}, frames_{"mrpt::obs::CSensoryFrame"},
      observations_{"mrpt::obs::CObservation"};
};

std::string placeIn(const UnpackingStream& stream) {
  return "byte " + std::to_string(stream.fileOffset()) + " of " + std::to_string(stream.fileBytes());
}

std::uint64_t estimateEntries(const std::string& path) {
  UnpackingStream stream(path);
  EntryEstimate estimate;
  for (std::string piece; !(piece = stream.take()).empty();) estimate.take(piece);
  return estimate.count();
}

constexpr size_t kLongestHeader = 4 + 127;

bool isLogEntry(const mrpt::rtti::TRuntimeClassId& id) {
  using namespace mrpt::obs;
  return id.derivedFrom(CLASS_ID(CActionCollection)) || id.derivedFrom(CLASS_ID(CSensoryFrame)) ||
         id.derivedFrom(CLASS_ID(CObservation)) || id.derivedFrom(CLASS_ID(CAction));
}

/// Looks at what MRPT reads, piece by piece, for what it would believe to its ruin, and throws before it
/// does.
class ObjectCheck {
 public:
  void take(std::string_view text) {
    if (isNamed(text, "CObservation2DRangeScan")) {
      begin(Inside::kScan);
    } else if (isNamed(text, "CActionRobotMovement2D")) {
      begin(Inside::kMotion);
    } else if (text.size() == sizeof(std::uint32_t)) {
      if (!is_old_version_) takeWord(text);
      is_old_version_ = false;
    } else if (inside_ == Inside::kMotion && text.size() > sizeof(std::uint32_t)) {
      takeName(std::string(text));
    }
    is_old_layout_ = text.size() == 3;  // the rest of a length in four bytes
  }

 private:
  enum class Inside { kOther, kScan, kMotion };

  /// With a namespace or, as in old logs, without.
  static bool isNamed(std::string_view text, std::string_view name) {
    return text.size() >= name.size() && text.substr(text.size() - name.size()) == name;
  }

  void begin(Inside inside) {
    inside_ = inside, words_ = 0;
    is_old_version_ = is_old_layout_;  // in four bytes, too
  }

  void takeWord(std::string_view text) {
    std::uint32_t word = 0;
    std::memcpy(&word, text.data(), sizeof word);  // both have the least byte first
    ++words_;
    // The number of beams stands third in a scan, behind its field of view and its longest range. MRPT makes
    // room for it without a look at whether there is any, and would write to nowhere.
    if (inside_ == Inside::kScan && words_ == 3 && word > kMostBeams) throw std::bad_alloc();  // passes MRPT
    // First in a motion: 0 where its odometry follows, which is read as what it is.
    if (inside_ == Inside::kMotion && words_ == 1 && word == 0) inside_ = Inside::kOther;
  }

  /// Of a motion's distribution. MRPT reads whatever object is there, has none when it is no distribution,
  /// and copies that.
  void takeName(const std::string& name) {
    inside_ = Inside::kOther;
    const auto* id = mrpt::rtti::findRegisteredClass(name);
    if (!id || !id->derivedFrom(CLASS_ID(mrpt::poses::CPosePDF)))
      throw std::runtime_error("a motion without a distribution");
  }

  static constexpr std::uint32_t kMostBeams = 10'000'000;
  Inside inside_ = Inside::kOther;
  int words_ = 0;
  bool is_old_layout_ = false, is_old_version_ = false;
};

/// Of logs of 2D lidars. Every number in them was damaged to see that MRPT, with ObjectCheck, bears it.
constexpr std::array<std::string_view, 12> kBorne{"CActionCollection",
                                                  "CActionRobotMovement2D",
                                                  "CSensoryFrame",
                                                  "CObservation2DRangeScan",
                                                  "CObservationOdometry",
                                                  "CObservationComment",
                                                  "CObservationIMU",
                                                  "CObservationRobotPose",
                                                  "CPose2D",
                                                  "CPose3D",
                                                  "CPosePDFGaussian",
                                                  "CPose3DPDFGaussian"};

/// True when this piece of a log is the name of a class of MRPT's that is not known to bear damage: several
/// of its observations write as much as a number claims to where they have no room for it.
bool isTriedFirst(std::string_view text) {
  constexpr std::string_view kNamespace = "mrpt::";
  const bool may_be_name =
      !text.empty() && (text[0] == 'C' || text.substr(0, kNamespace.size()) == kNamespace);
  if (!may_be_name || !mrpt::rtti::findRegisteredClass(std::string(text))) return false;
  const std::string_view name = text.substr(text.rfind(':') + 1);  // npos + 1 is 0
  return std::find(kBorne.begin(), kBorne.end(), name) == kBorne.end();
}

/// Of the stack, for objects inside objects: thousands of them.
constexpr std::ptrdiff_t kDeepestNesting_bytes = 1 << 20;

/// Reads from another stream and keeps what was read. Objects that a file nests without end would end the
/// stack, so that ends in an exception while there is room. `on_risk` is called before MRPT reads an object
/// of a class that it may crash at.
class CopyingStream : public mrpt::io::CStream {
 public:
  CopyingStream(UnpackingStream& source, std::string& copy, std::function<void()> on_risk)
      : source_(source), copy_(copy), on_risk_(std::move(on_risk)) {}
  size_t Read(void* buffer, size_t count) override {
    const char* const here = static_cast<const char*>(__builtin_frame_address(0));
    if (std::abs(outermost_ - here) > kDeepestNesting_bytes) throw std::runtime_error("nested without end");
    const size_t read = source_.Read(buffer, count);
    const std::string_view text(static_cast<const char*>(buffer), read);
    copy_.append(text);
    check_.take(text);
    if (isTriedFirst(text)) on_risk_();
    return read;
  }
  size_t Write(const void*, size_t) override { notOffered("writing"); }
  std::uint64_t Seek(std::int64_t, TSeekOrigin) override { notOffered("seeking"); }
  std::uint64_t getTotalBytesCount() const override { return source_.getTotalBytesCount(); }
  std::uint64_t getPosition() const override { return source_.getPosition(); }

 private:
  UnpackingStream& source_;
  std::string& copy_;
  std::function<void()> on_risk_;
  ObjectCheck check_;
  const char* const outermost_ = static_cast<const char*>(__builtin_frame_address(0));
};

}  // namespace

void requireUndamaged(const std::string& path) {
  using Failure = UnpackingStream::Failure;
  UnpackingStream stream(path);
  if (!stream.isPacked()) return;
  while (!stream.take().empty()) {
  }
  if (stream.failure() == Failure::kChecksum)
    throw core::InputError(path + ": corrupt: the " + stream.packing() + " checksum at " + placeIn(stream) +
                           " does not match, so one of its about " + std::to_string(estimateEntries(path)) +
                           " entries is wrong");
  if (stream.failure() == Failure::kDamaged) {
    const std::uint64_t begun = estimateEntries(path);
    throw core::InputError(path + ": corrupt: the " + stream.packing() + " data breaks at " +
                           placeIn(stream) + " (" + stream.failureText() + "), after about " +
                           std::to_string(begun > 0 ? begun - 1 : 0) + " good entries");
  }
}

bool looksLikeRawlog(const std::string& start) {
  const auto header = headerAt(start);
  return !header.class_name.empty() || header.is_cut;
}

RawlogObjects::RawlogObjects(const std::string& path, Trial trial)
    : path_(path), trial_(trial), stream_(path) {
  // Linked libraries of which nothing is called are dropped, and their classes with them.
  mrpt::maps::registerAllClasses_mrpt_maps();
  // MRPT's parsers trust what they read, to the point of crashing on damaged bytes.
  requireUndamaged(path);
}

double RawlogObjects::fractionRead() const {
  return static_cast<double>(stream_.fileOffset()) / static_cast<double>(stream_.fileBytes());
}

void RawlogObjects::fail(UnpackingStream::Failure failure, const std::string& otherwise) const {
  using Failure = UnpackingStream::Failure;
  const std::string place = placeIn(stream_);
  const std::string good = std::to_string(count_) + (count_ == 1 ? " good entry" : " good entries");
  const std::string after = ", after " + good;
  if (failure == Failure::kTruncated)
    throw core::InputError(path_ + ": truncated: ends at " + place + " inside an entry" + after);
  throw core::InputError(path_ + ": corrupt near " + place + " (" + otherwise + ")" + after);
}

/// Throws unless an object of a class that can be read starts here.
void RawlogObjects::checkHeader() {
  const auto header = headerAt(stream_.peek(kLongestHeader));
  const std::string& name = header.class_name;
  if (name == "nullptr") return;
  const auto* id = name.empty() ? nullptr : mrpt::rtti::findRegisteredClass(name);
  if (id && (count_ > 0 || isLogEntry(*id))) return;
  if (stream_.failure() != UnpackingStream::Failure::kNone) fail(stream_.failure());
  if (count_ > 0 && header.is_cut) fail(UnpackingStream::Failure::kTruncated);
  if (count_ > 0)
    fail(UnpackingStream::Failure::kNone,
         name.empty() ? "no entry starts here" : "an entry of the unknown class '" + name + "'");
  throw core::InputError(path_ + ": is not an MRPT rawlog: it starts with " +
                         (name.empty() ? std::string("other data") : "an object of class '" + name + "'"));
}

void RawlogObjects::tryFirst() {
  if (trial_ == Trial::kNone) return;
  const auto read_all = [this](const files::TrialRun::Tell& tell) {
    RawlogObjects objects(path_, Trial::kNone);
    while (objects.next()) tell(objects.count());
  };
  if (!trial_run_) trial_run_ = std::make_unique<files::TrialRun>(read_all);
  if (!trial_run_->survives(count_)) throw std::runtime_error("MRPT crashes at it");
}

std::shared_ptr<mrpt::serialization::CSerializable> RawlogObjects::next() {
  bytes_.clear();
  CopyingStream copying(stream_, bytes_, [this] { tryFirst(); });
  auto archive = mrpt::serialization::archiveFrom<mrpt::io::CStream>(copying);
  for (;;) {
    if (stream_.peek(1).empty()) {
      if (stream_.failure() != UnpackingStream::Failure::kNone) fail(stream_.failure());
      return nullptr;
    }
    checkHeader();
    std::shared_ptr<mrpt::serialization::CSerializable> object;
    try {
      const files::MemoryGuard guard(files::kObjectHeadroom_bytes);
      object = archive.ReadObject();
    } catch (const std::bad_alloc&) {
      fail(stream_.failure(), "an entry of impossible size");
    } catch (const std::length_error&) {
      fail(stream_.failure(), "an entry of impossible size");
    } catch (const std::exception&) {
      fail(stream_.failure(), "an entry that cannot be read");
    }
    ++count_;
    if (object) return object;
  }
}

PackingStream::PackingStream(const std::string& path, std::string final_path)
    : file_(path, std::move(final_path)) {}

void PackingStream::rethrowFailure() const {
  if (failure_) throw core::IoError(*failure_);
}

size_t PackingStream::Write(const void* buffer, size_t count) {
  try {
    file_.write({static_cast<const char*>(buffer), count});
  } catch (const core::IoError& error) {
    failure_ = error.what();
    throw;
  }
  position_ += count;
  return count;
}

void PackingStream::close() {
  file_.close();
}

size_t PackingStream::Read(void*, size_t) {
  notOffered("reading");
}
std::uint64_t PackingStream::Seek(std::int64_t, TSeekOrigin) {
  notOffered("seeking");
}

RawlogSink::RawlogSink(const std::string& path) : pending_(path), stream_(pending_.path(), path) {}

void RawlogSink::write(const mrpt::serialization::CSerializable& object) {
  if (closed_) throw core::ContractError("rawlog: write() after close()");
  auto archive = mrpt::serialization::archiveFrom<mrpt::io::CStream>(stream_);
  try {
    archive << object;
  } catch (const std::exception&) {
    // MRPT may have dressed the stream's error in a back trace.
    stream_.rethrowFailure();
    throw;
  }
}

void RawlogSink::close() {
  if (closed_) throw core::ContractError("rawlog: closed twice");
  closed_ = true;
  stream_.close();
  pending_.commit();
}

}  // namespace slam::rawlogs
