// The server's configuration: its schema and its reader say the same, and each value comes from
// where it should.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "cli/serve_fields.h"
#include "cli/serve_layers.h"
#include "core/base/files.h"
#include "tests/support/error_of.h"
#include "tests/support/program.h"
#include "tests/support/small_bake.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

namespace fs = std::filesystem;

using nlohmann::json;
using test::error_of;
using test::ProgramResult;
using test::run_program;

json schema() {
  return json::parse(
      read_file("docs/protocol/schema/server_config.schema.json", std::size_t{1} << 20));
}

/// What reading that one field says; "no error" when it is taken.
std::string fault_of(const ServeField& field, const json& value) {
  ServeConfig config;
  return error_of([&] { field.read(JsonReader(value, field.name), {}, config); });
}

TEST(ServeSchema, HasEveryFieldOfTheReaderWithTheSameDefaultAndNoOther) {
  const json properties = schema().at("properties");
  std::set<std::string> names;
  for (const ServeField& field : serve_fields()) {
    EXPECT_TRUE(names.insert(field.name).second) << field.name << " twice";
    ASSERT_TRUE(properties.contains(field.name)) << field.name;
    const json shown = field.show(ServeConfig{});
    const json& property = properties.at(field.name);
    if (property.contains("default")) {
      EXPECT_EQ(property.at("default"), shown) << field.name;
    } else {
      EXPECT_TRUE(shown.is_null() || shown.empty()) << field.name << " is " << shown;
    }
  }
  EXPECT_EQ(names.size(), properties.size());
  EXPECT_FALSE(schema().at("additionalProperties").get<bool>());
}

TEST(ServeSchema, HasTheBoundsAndWordsOfTheReader) {
  const json properties = schema().at("properties");
  int bounds = 0, words = 0;
  for (const ServeField& field : serve_fields()) {
    const json& property = properties.at(field.name);
    const bool is_number = property.contains("minimum");
    EXPECT_EQ(is_number, field.form == ServeField::Form::number) << field.name;
    if (is_number) {
      ++bounds;
      const auto low = property.at("minimum").get<std::int64_t>();
      const auto high = property.at("maximum").get<std::int64_t>();
      EXPECT_EQ(fault_of(field, low), "no error") << field.name;
      EXPECT_EQ(fault_of(field, high), "no error") << field.name;
      EXPECT_NE(fault_of(field, low - 1), "no error") << field.name;
      EXPECT_NE(fault_of(field, high + 1), "no error") << field.name;
      const bool takes_fractions = fault_of(field, static_cast<double>(low) + 0.5) == "no error";
      EXPECT_EQ(property.at("type"), takes_fractions ? "number" : "integer") << field.name;
    }
    if (property.contains("enum")) {
      ++words;
      for (const json& word : property.at("enum")) {
        EXPECT_EQ(fault_of(field, word), "no error") << word;
      }
      EXPECT_NE(fault_of(field, "another"), "no error") << field.name;
    }
    const bool is_flag = property.at("type") == "boolean";
    EXPECT_EQ(is_flag, field.form == ServeField::Form::flag) << field.name;
    for (const json& other : {json(nullptr), json(true), json::object(), json(-1e300)}) {
      if (is_flag && other.is_boolean()) continue;
      EXPECT_NE(fault_of(field, other), "no error") << field.name << " " << other;
    }
  }
  EXPECT_GE(bounds, 10);
  EXPECT_GE(words, 2);
}

TEST(ServeSchema, AndTheReaderTakeAndRefuseTheSameExamples) {
  int read = 0;
  for (const char* const kind : {"good", "bad", "bad_beyond_schema"}) {
    for (const auto& entry : fs::directory_iterator(fs::path("tests/cli/configurations") / kind)) {
      ++read;
      const std::string fault = error_of([&] { (void)read_serve_config(entry.path()); });
      EXPECT_EQ(fault == "no error", std::string(kind) == "good") << entry.path() << ": " << fault;
      if (fault != "no error") {
        EXPECT_NE(fault.find(entry.path().filename().string()), std::string::npos) << fault;
      }
    }
  }
  EXPECT_GE(read, 20);
  const json all = schema();  // a range of a temporary's would be gone at its first step
  for (const json& example : all.at("examples")) {
    const test::TemporaryFolder folder;
    std::ofstream(folder / "example.json") << example;
    EXPECT_EQ(error_of([&] { (void)read_serve_config(folder / "example.json"); }), "no error");
  }
  EXPECT_EQ(error_of([] { (void)read_serve_config("configs/server.json"); }), "no error");
}

TEST(ServeSchema, WhatIsShownCanBeReadAgain) {
  ServeConfig config;
  for (const ServeField& field : serve_fields()) {
    const json shown = field.show(config);
    if (shown.is_null() || field.name == "bakes") continue;
    EXPECT_EQ(fault_of(field, shown), "no error") << field.name << " " << shown;
  }
}

class ServeLayers : public testing::Test {
 protected:
  ServeLayers() {
    std::ofstream(folder / "server.json")
        << R"({ "port": 1, "quiet_ms": 1, "jpeg_quality": 1, "store": "s.sqlite",
                "host_names": ["file.example"], "origins": ["http://file.example"] })";
  }
  test::TemporaryFolder folder;
};

TEST_F(ServeLayers, FlagsAndFilesOfTlsComeFromTheEnvironmentToo) {
  const LayeredConfig layers = layer_config({},
                                            {{"RIMLIGHT_SELFTEST_ECHO", "true"},
                                             {"RIMLIGHT_TLS_CERTIFICATE", "chain.pem"},
                                             {"RIMLIGHT_TLS_KEY", "key.pem"}},
                                            {{"tls_key", "other.pem"}});
  EXPECT_TRUE(layers.config.network.selftest_echo);
  EXPECT_EQ(layers.config.network.tls.certificate, "chain.pem");
  EXPECT_EQ(layers.config.network.tls.key, "other.pem");
  const std::string fault = error_of([] {
    (void)layer_config({}, {{"RIMLIGHT_SELFTEST_ECHO", "yes"}}, {});
  });
  EXPECT_NE(fault.find("RIMLIGHT_SELFTEST_ECHO"), std::string::npos) << fault;
}

TEST_F(ServeLayers, OptionsOverEnvironmentOverFileOverDefaults) {
  const LayeredConfig layers =
      layer_config(folder / "server.json",
                   {{"RIMLIGHT_PORT", "2"}, {"RIMLIGHT_QUIET_MS", "2"}, {"RIMLIGHT_LOG", "json"}},
                   {{"port", 3}, {"budget", "3ms"}});
  EXPECT_EQ(layers.config.network.port, 3);
  EXPECT_EQ(layers.config.sessions.session.quiet, std::chrono::milliseconds(2));
  EXPECT_EQ(layers.config.sessions.session.jpeg_quality, 1);
  EXPECT_EQ(layers.config.store, folder / "s.sqlite");
  EXPECT_EQ(layers.config.log, LogFormat::json);
  EXPECT_EQ(budget_name(layers.config.draw.relight.budget), "3ms");
  EXPECT_EQ(layers.sources.at("port"), ValueSource::option);
  EXPECT_EQ(layers.sources.at("quiet_ms"), ValueSource::environment);
  EXPECT_EQ(layers.sources.at("jpeg_quality"), ValueSource::file);
  EXPECT_EQ(layers.sources.at("most_sessions"), ValueSource::built_in);
  EXPECT_EQ(layers.sources.size(), serve_fields().size());
}

TEST_F(ServeLayers, EveryFieldHasItsVariable) {
  for (const ServeField& field : serve_fields()) {
    const json shown = field.show(ServeConfig{});
    std::string text = shown.is_string() ? shown.get<std::string>() : shown.dump();
    if (shown.is_null() || shown.empty()) {
      text = field.form == ServeField::Form::number ? "7" : "http://a.example,http://b.example";
    }
    const LayeredConfig layers = layer_config({}, {{field.variable(), text}}, {});
    EXPECT_EQ(layers.sources.at(field.name), ValueSource::environment) << field.variable();
    EXPECT_TRUE(layers.unknown_variables.empty()) << field.variable();
  }
}

TEST_F(ServeLayers, ListsOfTheEnvironmentReplaceTheFilesAndThoseOfOptionsAddToThem) {
  const LayeredConfig layers =
      layer_config(folder / "server.json", {{"RIMLIGHT_HOST_NAMES", "a.example,b.example"}},
                   {{"host_names", {"c.example"}}, {"origins", {"http://d.example"}}});
  EXPECT_EQ(layers.config.network.host_names,
            (std::vector<std::string>{"a.example", "b.example", "c.example"}));
  EXPECT_EQ(layers.config.network.origins,
            (std::vector<std::string>{"http://file.example", "http://d.example"}));
  const LayeredConfig none =
      layer_config(folder / "server.json", {{"RIMLIGHT_HOST_NAMES", ""}}, {});
  EXPECT_TRUE(none.config.network.host_names.empty());
}

TEST_F(ServeLayers, TheFileMayBeNamedByTheEnvironmentAndTheOptionGoesFirst) {
  const std::string file = (folder / "server.json").string();
  EXPECT_EQ(layer_config({}, {{"RIMLIGHT_CONFIG", file}}, {}).config.network.port, 1);
  EXPECT_EQ(layer_config(file, {{"RIMLIGHT_CONFIG", "/none.json"}}, {}).config.network.port, 1);
}

TEST_F(ServeLayers, ErrorsNameTheVariableOrTheOptionAndUnknownVariablesAreKnown) {
  const auto fault = [](const Variables& environment, const OptionValues& options) {
    return error_of([&] { (void)layer_config({}, environment, options); });
  };
  for (const char* const bad : {"", "many", "70000", "-1", "80.5", "[80]", "\"80\"", "80 81"}) {
    EXPECT_EQ(fault({{"RIMLIGHT_PORT", bad}}, {}).substr(0, 21), "RIMLIGHT_PORT: found ") << bad;
  }
  EXPECT_EQ(fault({{"RIMLIGHT_BUDGET", "8 parsecs"}}, {}).substr(0, 16), "RIMLIGHT_BUDGET:");
  EXPECT_EQ(fault({}, {{"budget", "8 parsecs"}}).substr(0, 9), "--budget:");
  EXPECT_EQ(layer_config({}, {{"RIMLIGHT_PROT", "1"}}, {}).unknown_variables,
            std::vector<std::string>{"RIMLIGHT_PROT"});
}

/// A variable that is set while it lives.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) {
    ::setenv(name, value.c_str(), 1);
  }
  ~Variable() { ::unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
};

class CheckConfig : public testing::Test {
 protected:
  CheckConfig() { test::write_small_bake(folder / "a.bake", {}); }
  ProgramResult check(std::vector<std::string> more) {
    std::vector<std::string> arguments{"serve", "--check-config"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
  }
  std::string path(const char* name) const { return (folder / name).string(); }

  test::TemporaryFolder folder;
};

TEST_F(CheckConfig, SaysWhatWouldBeUsedAndWhereItComesFrom) {
  std::ofstream(folder / "server.json") << R"({ "bakes": ["a.bake"], "store": "s.sqlite" })";
  const Variable port("RIMLIGHT_PORT", "1234"), misspelt("RIMLIGHT_PROT", "1");
  const ProgramResult result =
      check({"--config", path("server.json"), "--budget", "4ms", "--json"});
  ASSERT_EQ(result.status, 0) << result.errors;
  const json found = json::parse(result.output);
  const json& settings = found.at("settings");
  EXPECT_EQ(settings.at("port"), json({{"value", 1234}, {"from", "environment"}}));
  EXPECT_EQ(settings.at("budget"), json({{"value", "4ms"}, {"from", "option"}}));
  EXPECT_EQ(settings.at("store"), json({{"value", path("s.sqlite")}, {"from", "file"}}));
  EXPECT_EQ(settings.at("log"), json({{"value", "text"}, {"from", "default"}}));
  EXPECT_EQ(settings.size(), serve_fields().size());
  EXPECT_EQ(found.at("scenes").at(0).at("name"), "a");
  EXPECT_EQ(found.at("scenes").at(0).at("width"), 70);
  EXPECT_GT(found.at("page_files").get<int>(), 5);
  EXPECT_EQ(found.at("store"), "new");
  EXPECT_FALSE(fs::exists(folder / "s.sqlite")) << "a check makes nothing";
  const json& unknown = found.at("unknown_variables");
  EXPECT_NE(std::find(unknown.begin(), unknown.end(), "RIMLIGHT_PROT"), unknown.end());
  const ProgramResult text = check({"--config", path("server.json")});
  EXPECT_EQ(text.status, 0);
  EXPECT_NE(text.output.find("1234 (environment RIMLIGHT_PORT)"), std::string::npos) << text.output;
  EXPECT_NE(text.output.find("RIMLIGHT_PROT: set, but no setting"), std::string::npos);
}

TEST_F(CheckConfig, RefusesWhatTheServerWould) {
  const auto status = [&](std::vector<std::string> more, const std::string& says) {
    const ProgramResult result = check(std::move(more));
    EXPECT_NE(result.errors.find(says), std::string::npos) << result.errors;
    EXPECT_EQ(result.output, "");
    return result.status;
  };
  EXPECT_EQ(status({path("none.bake")}, "none.bake"), 1);
  EXPECT_EQ(status({path("a.bake"), path("a.bake")}, "\"a\""), 1);
  EXPECT_EQ(status({}, "bake"), 1);
  EXPECT_EQ(status({path("a.bake"), "--key", path("none.json")}, "none.json"), 1);
  EXPECT_EQ(status({path("a.bake"), "--store", path("none/s.sqlite")}, "none/s.sqlite"), 1);
  EXPECT_EQ(status({path("a.bake"), "--web", path("none")}, "none"), 1);
  EXPECT_EQ(status({path("a.bake"), "--host", "0.0.0.0"}, "signing keys"), 1);
  EXPECT_EQ(status({path("a.bake"), "--origin", "a.example"}, "a.example"), 1);
  EXPECT_EQ(status({path("a.bake"), "--port", "many"}, "--port"), 2);
  EXPECT_EQ(status({path("a.bake"), "--log", "xml"}, "--log"), 2);
  std::ofstream(folder / "bad.sqlite") << std::string(5000, 'x');
  EXPECT_EQ(status({path("a.bake"), "--store", path("bad.sqlite")}, "bad.sqlite"), 1);
}

TEST_F(CheckConfig, LeavesAStoreThatIsInUseAlone) {
  test::RunningProgram server(
      {"serve", path("a.bake"), "--port", "0", "--store", path("s.sqlite"), "--json"});
  while (server.is_running() && server.output().find('\n') == std::string::npos) {
  }
  ASSERT_TRUE(server.is_running()) << server.errors();
  const ProgramResult result = check({path("a.bake"), "--store", path("s.sqlite"), "--json"});
  ASSERT_EQ(result.status, 0) << result.errors;
  EXPECT_EQ(json::parse(result.output).at("store"), "in use");
  server.terminate();
  EXPECT_EQ(server.wait().status, 0);
  const ProgramResult later = check({path("a.bake"), "--store", path("s.sqlite"), "--json"});
  EXPECT_EQ(json::parse(later.output).at("store"), "whole");
}

}  // namespace
}  // namespace rimlight
