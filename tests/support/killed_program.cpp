#include "tests/support/killed_program.h"

#include <sstream>
#include <utility>

#include "core/base/files.h"

namespace rimlight::test {

const char* to_string(KillPoint::Phase phase) {
  switch (phase) {
    case KillPoint::Phase::before:
      return "before";
    case KillPoint::Phase::half:
      return "half";
    case KillPoint::Phase::after:
      return "after";
  }
  return "unknown";
}

WatchedProgram::WatchedProgram(std::filesystem::path folder, std::vector<std::string> variables)
    : folder_(std::move(folder)), report_(folder_), variables_(std::move(variables)) {
  report_ += ".operations";  // beside the folder, not in it
}

std::vector<std::string> WatchedProgram::command(const std::vector<std::string>& more,
                                                 const std::vector<std::string>& arguments) const {
  std::vector<std::string> all = {std::string("LD_PRELOAD=") + RIMLIGHT_FAULT_SHIM,
                                  "RIMLIGHT_FAULT_FOLDER=" + folder_.string(),
                                  "RIMLIGHT_FAULT_REPORT=" + report_.string()};
  for (const auto* const part : {&variables_, &more}) {
    all.insert(all.end(), part->begin(), part->end());
  }
  all.emplace_back(RIMLIGHT_PROGRAM);
  all.insert(all.end(), arguments.begin(), arguments.end());
  return all;
}

std::vector<std::string> WatchedProgram::counting(const std::vector<std::string>& arguments) const {
  return command({}, arguments);
}

std::vector<std::string> WatchedProgram::killed(const KillPoint& point,
                                                const std::vector<std::string>& arguments) const {
  std::vector<std::string> more = {"RIMLIGHT_FAULT_AT=" + std::to_string(point.number),
                                   "RIMLIGHT_FAULT_KIND=" + point.kind,
                                   std::string("RIMLIGHT_FAULT_PHASE=") + to_string(point.phase)};
  if (point.loses_power) more.emplace_back("RIMLIGHT_FAULT_LOSES=1");
  return command(more, arguments);
}

std::vector<DiskOperation> WatchedProgram::operations() const {
  if (!std::filesystem::exists(report_)) return {};
  std::istringstream lines(read_file(report_, std::size_t{16} << 20));
  std::filesystem::remove(report_);
  std::vector<DiskOperation> operations;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t space = line.find(' ');
    operations.push_back({line.substr(0, space), line.substr(space + 1)});
  }
  return operations;
}

ProgramResult WatchedProgram::run(const std::vector<std::string>& command) {
  return RunningProgram("env", command).wait();
}

}  // namespace rimlight::test
