#include "volumes/io/hdf5/plugin/hdf5_file.h"

#include <cstring>
#include <utility>

#include "volumes/base/error.h"
#include "volumes/io/bytes/text_header.h"

namespace supple::hdf5 {

namespace {

herr_t keep_innermost(unsigned depth, const H5E_error2_t* error, void* client) noexcept {
  auto* failure = static_cast<Failure*>(client);
  const char* text = error->desc == nullptr ? "" : error->desc;
  const char* errno_text = std::strstr(text, "errno = ");
  if (errno_text != nullptr) failure->errno_value = std::atoi(errno_text + 8);
  try {
    if (depth == 0) failure->reason = printable(text);
  } catch (const std::bad_alloc&) {  // the damage may have used up the memory limit
    failure->reason.clear();
  }
  return 0;
}

/// Called by the library before it follows a link into another file: it must not.
herr_t refuse_other_file(const char*, const char*, const char* file, const char*, unsigned*, hid_t,
                         void* client) noexcept {
  *static_cast<std::string*>(client) = file;
  return -1;
}

herr_t collect_link(hid_t, const char* name, const H5L_info_t* info, void* client) noexcept {
  // Number of links far beyond what files of images hold.
  constexpr std::size_t kMaxLinks = 20000;
  auto* names = static_cast<std::vector<std::string>*>(client);
  try {
    if (info->type == H5L_TYPE_HARD) names->emplace_back(name);
  } catch (const std::bad_alloc&) {
    return -1;
  }
  return names->size() > kMaxLinks ? 1 : 0;
}

const char* class_name(H5T_class_t type_class) {
  switch (type_class) {
    case H5T_INTEGER:
      return "integers of an unusual size";
    case H5T_FLOAT:
      return "floats of an unusual size";
    case H5T_STRING:
      return "strings";
    case H5T_BITFIELD:
      return "bit fields";
    case H5T_OPAQUE:
      return "opaque bytes";
    case H5T_COMPOUND:
      return "compound values";
    case H5T_REFERENCE:
      return "references";
    case H5T_VLEN:
      return "values of variable length";
    case H5T_ARRAY:
      return "arrays as values";
    default:
      return "values of an unknown class";
  }
}

std::optional<ValueType> numeric_type_of(hid_t type) {
  const std::size_t size = H5Tget_size(type);
  const std::string bits = std::to_string(8 * size);
  ValueType found;
  switch (H5Tget_class(type)) {
    case H5T_INTEGER:
      if (find_numpy_type((H5Tget_sign(type) == H5T_SGN_NONE ? "uint" : "int") + bits, found)) {
        return found;
      }
      return {};
    case H5T_FLOAT:
      if (size == 2) return ValueType::float32;
      if (find_numpy_type("float" + bits, found)) return found;
      return {};
    case H5T_ENUM: {
      const Hdf5Handle integers(H5Tget_super(type), H5Tclose);
      return numeric_type_of(integers.get());
    }
    default:
      return {};
  }
}

}  // namespace

Hdf5Handle::Hdf5Handle(Hdf5Handle&& other) noexcept
    : m_id(std::exchange(other.m_id, H5I_INVALID_HID)), m_close(other.m_close) {}

Hdf5Handle& Hdf5Handle::operator=(Hdf5Handle&& other) noexcept {
  close();
  m_id = std::exchange(other.m_id, H5I_INVALID_HID);
  m_close = other.m_close;
  return *this;
}

bool Hdf5Handle::close() {
  const hid_t id = std::exchange(m_id, H5I_INVALID_HID);
  return id < 0 || m_close(id) >= 0;
}

Failure last_failure() {
  Failure failure{"unknown damage"};
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_innermost, &failure);
  H5Eclear2(H5E_DEFAULT);
  return failure;
}

void prepare_library() {
  H5dont_atexit();
  H5open();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  H5PLset_loading_state(0);
}

hid_t native_type(ValueType type) {
  switch (type) {
    case ValueType::int8:
      return H5T_NATIVE_INT8;
    case ValueType::uint8:
      return H5T_NATIVE_UINT8;
    case ValueType::int16:
      return H5T_NATIVE_INT16;
    case ValueType::uint16:
      return H5T_NATIVE_UINT16;
    case ValueType::int32:
      return H5T_NATIVE_INT32;
    case ValueType::uint32:
      return H5T_NATIVE_UINT32;
    case ValueType::int64:
      return H5T_NATIVE_INT64;
    case ValueType::uint64:
      return H5T_NATIVE_UINT64;
    case ValueType::float32:
      return H5T_NATIVE_FLOAT;
    case ValueType::float64:
      return H5T_NATIVE_DOUBLE;
  }
  throw Error("no such value type");
}

Hdf5File::Hdf5File(const std::string& path, std::string shown) : m_shown(std::move(shown)) {
  prepare_library();
  m_links = Hdf5Handle(H5Pcreate(H5P_LINK_ACCESS), H5Pclose);
  H5Pset_elink_cb(m_links.get(), refuse_other_file, &m_left_for);
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  // Locks fail on some network file systems, and a reader needs none.
  H5Pset_file_locking(access.get(), false, true);
  m_file = Hdf5Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose);
  if (!m_file.is_open()) fail_library("HDF5");
}

void Hdf5File::fail(const std::string& field, const std::string& found,
                    const std::string& expected) const {
  throw InputError({m_shown, printable(field), found, expected});
}

void Hdf5File::fail_library(const std::string& field) const {
  const Failure failure = last_failure();
  if (!m_left_for.empty()) {
    fail(field, "a link into the file " + printable(m_left_for), "a dataset inside the file");
  }
  fail(field, failure.reason, "an intact HDF5 file");
}

bool Hdf5File::has(const std::string& object) const {
  m_left_for.clear();
  for (std::size_t at = object.find('/', 1);; at = object.find('/', at + 1)) {
    const std::string part = object.substr(0, at);
    if (part != "/" && part.back() != '/') {
      const htri_t is_link = H5Lexists(m_file.get(), part.c_str(), m_links.get());
      if (is_link < 0) fail_library(part);
      if (is_link == 0) return false;
      const htri_t leads = H5Oexists_by_name(m_file.get(), part.c_str(), m_links.get());
      if (leads < 0 || !m_left_for.empty()) fail_library(part);
      if (leads == 0) return false;
    }
    if (at == std::string::npos) return true;
  }
}

Hdf5Handle Hdf5File::open(const std::string& object) const {
  if (!has(object)) fail(object, "nothing", "a dataset of the file");
  Hdf5Handle id(H5Oopen(m_file.get(), object.c_str(), m_links.get()), H5Oclose);
  if (!id.is_open()) fail_library(object);
  return id;
}

haddr_t Hdf5File::address(const std::string& object) const {
  const Hdf5Handle id = open(object);
  H5O_info_t info;
  if (H5Oget_info2(id.get(), &info, H5O_INFO_BASIC) < 0) fail_library(object);
  return info.addr;
}

std::vector<Hdf5File::Entry> Hdf5File::children(const std::string& group) const {
  const Hdf5Handle id = open(group);
  std::vector<std::string> names;
  const herr_t result =
      H5Literate(id.get(), H5_INDEX_NAME, H5_ITER_INC, nullptr, collect_link, &names);
  if (result < 0) fail_library(group);
  if (result > 0) fail(group, "more than 20000 links", "fewer, or a path behind the file's name");
  std::vector<Entry> entries;
  for (const std::string& name : names) {
    const std::string path = (group == "/" ? "" : group) + "/" + name;
    const Hdf5Handle child = open(path);
    const H5I_type_t type = H5Iget_type(child.get());
    if (type == H5I_GROUP || type == H5I_DATASET) entries.push_back({path, type == H5I_GROUP});
  }
  return entries;
}

std::optional<ValueType> Hdf5File::numeric_type(const Dataset& dataset,
                                                std::string& refused) const {
  const Hdf5Handle type(H5Dget_type(dataset.id.get()), H5Tclose);
  if (!type.is_open()) fail_library(dataset.path);
  const std::optional<ValueType> numeric = numeric_type_of(type.get());
  if (!numeric) refused = class_name(H5Tget_class(type.get()));
  return numeric;
}

}  // namespace supple::hdf5
