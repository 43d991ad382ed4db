#include "tools/output/output_folder.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace curbstone::output {

namespace fs = std::filesystem;

OutputFolder::OutputFolder(fs::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  for (fs::path made = folder_; !made.empty() && !fs::exists(made, error); made = made.parent_path())
    made_.push_back(made);
  fs::create_directories(folder_, error);
  if (!fs::is_directory(folder_))
    throw std::runtime_error(fmt::format("{}: cannot be made a folder", folder_.string()));
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  for (const auto& [part, name] : parts_) fs::remove(part, ignored);
  for (const fs::path& folder : made_) fs::remove(folder, ignored);  // only if it is empty
}

void OutputFolder::add(const std::string& name, const std::function<void(const std::string& path)>& write) {
  parts_.emplace_back(folder_ / (name + ".part"), name);
  write(parts_.back().first.string());
}

void OutputFolder::add_bytes(const std::string& name, std::string_view bytes) {
  add(name, [&](const std::string& path) {
    errno = 0;
    std::ofstream out(path, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.flush();
    if (!out) throw std::runtime_error(fmt::format("{}: cannot be written: {}", path, std::strerror(errno)));
  });
}

void OutputFolder::leave_out(const std::string& name) {
  left_out_.push_back(name);
}

std::vector<std::string> OutputFolder::commit() {
  std::vector<std::string> names;
  for (const std::string& name : left_out_) {
    std::error_code ignored;
    fs::remove(folder_ / name, ignored);
  }
  for (const auto& [part, name] : parts_) {
    std::error_code error;
    fs::rename(part, folder_ / name, error);
    if (error)
      throw std::runtime_error(fmt::format("{}: cannot be written: {}", (folder_ / name).string(), error.message()));
    names.push_back(name);
  }
  parts_.clear();
  made_.clear();
  return names;
}

}  // namespace curbstone::output
