// HDF5 files as the readers and the writer see them: handles that close themselves, errors with
// the library's own reason, and nothing outside the file: links into other files, virtual datasets,
// external storage and filters from plugins are refused. The library never prints.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <hdf5.h>

#include "volumes/io/format/volume_file.h"

namespace supple::hdf5 {

/// Owns an identifier of the library.
class Hdf5Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Hdf5Handle() = default;
  Hdf5Handle(hid_t id, Close closer) : m_id(id), m_close(closer) {}
  ~Hdf5Handle() { close(); }
  Hdf5Handle(Hdf5Handle&& other) noexcept;
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept;

  hid_t get() const { return m_id; }
  bool is_open() const { return m_id >= 0; }
  /// Closes it; false when the library reports a failure, as of a flush to a full disk.
  bool close();

 private:
  hid_t m_id = H5I_INVALID_HID;
  Close m_close = nullptr;
};

/// Reason why the library's last call failed.
struct Failure {
  std::string reason;   // its innermost message, one line
  int errno_value = 0;  // 0 where the system was not at fault
};
Failure last_failure();

/// Turns off messages, plugins and work at exit. To be called before anything else.
void prepare_library();

/// The type of values in memory.
hid_t native_type(ValueType type);

/// A dataset whose storage lies inside the file and whose filters are built in.
struct Dataset {
  std::string path;  // inside the file
  Hdf5Handle id;
  std::vector<hsize_t> dims;   // slowest first; empty for a scalar
  std::vector<hsize_t> chunk;  // empty unless chunked
  std::int64_t storage = 0;    // bytes that the values take in the file
};

/// An open file that does not change.
class Hdf5File {
 public:
  /// `shown` is how errors name it. Throws InputError for a file that is no intact HDF5 file.
  Hdf5File(const std::string& path, std::string shown);
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  hid_t get() const { return m_file.get(); }
  const std::string& shown() const { return m_shown; }
  [[noreturn]] void fail(const std::string& field, const std::string& found,
                         const std::string& expected) const;
  /// Throws InputError with the reason of the library's last failure.
  [[noreturn]] void fail_library(const std::string& field) const;

  /// True if the object is there; false also for a link that leads nowhere.
  bool has(const std::string& object) const;
  /// A group or dataset. Throws InputError also for a link out of the file.
  Hdf5Handle open(const std::string& object) const;
  /// Throws InputError: no such dataset, a group, storage or filters that are refused.
  Dataset open_dataset(const std::string& path) const;
  /// The values' type where they are numbers; 16-bit floats become float32, enumerations (h5py's
  /// bool) their integers. Empty with the class in `refused` where not.
  std::optional<ValueType> numeric_type(const Dataset& dataset, std::string& refused) const;

  struct Entry {
    std::string path;
    bool is_group;
  };
  /// Children of a group by name, through hard links only.
  std::vector<Entry> children(const std::string& group) const;
  /// Identifies an object that several links name.
  haddr_t address(const std::string& object) const;

  /// Small datasets as numbers or text; at most `limit` numbers, 1 MiB of text.
  std::vector<double> numbers(const std::string& path, std::size_t limit) const;
  std::string text(const std::string& path) const;
  /// Attributes; empty where the object has none of this name.
  std::optional<std::vector<double>> attribute_numbers(const std::string& object,
                                                       const std::string& name,
                                                       std::size_t limit) const;
  std::optional<std::string> attribute_text(const std::string& object,
                                            const std::string& name) const;

 private:
  std::string m_shown;
  mutable std::string m_left_for;  // the other file that a link named last
  Hdf5Handle m_links;              // link access that never leaves the file
  Hdf5Handle m_file;
};

}  // namespace supple::hdf5
