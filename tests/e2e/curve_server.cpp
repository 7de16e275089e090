// curve_server WEB: serves the page with a closed-form scene whose BRDFs are edited, on a free
// port, until it is asked to stop. Prints {"address": …}.
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <thread>

#include "server/network/http_server.h"
#include "server/schedule/render_queue.h"
#include "tests/server/curve_sphere.h"
#include "tests/server/sphere_source.h"

int main(int argc, char** argv) {
  using namespace rimlight::server;
  if (argc != 2) {
    std::fprintf(stderr, "usage: curve_server WEB\n");
    return 2;
  }
  try {
    const StaticFiles files(argv[1]);
    const SceneCatalog scenes(
        {test::curve_sphere_scene("curves", 256), test::sphere_scene("sphere", 64, 64)});
    RenderQueue queue;
    SessionRegistry sessions(scenes, queue, {});
    HttpServer http({.port = 0}, files, sessions);
    std::jthread compute([&queue](const std::stop_token& stop) { queue.run(stop); });
    std::printf("%s\n", nlohmann::json{{"address", http.address() + "/"}}.dump().c_str());
    std::fflush(stdout);
    http.run(HttpServer::Signals::watch);
    sessions.close_all();
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "curve_server: %s\n", error.what());
    return 1;
  }
}
