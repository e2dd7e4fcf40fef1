#include "derive/play/server/serve.hpp"

#include <chrono>
#include <fmt/format.h>
#include <functional>
#include <httplib.h>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "derive/play/page.hpp"
#include "derive/play/server/native_engine.hpp"

namespace cdot::play {

using nlohmann::json;

struct PageServer::Parts {
  Parts(std::string start_, std::filesystem::path specs_, std::filesystem::path engine_,
        const std::filesystem::path& program)
      : start(std::move(start_)), specs(std::move(specs_)), engine(std::move(engine_)), engines(program) {}

  std::string start;
  std::filesystem::path specs, engine;
  int port = 0;
  std::mutex derives;  // one request at a time
  NativeEngines engines;
  httplib::Server server;

  // Other pages of the browser cannot ask: not under a name of their own that leads here, and not from elsewhere.
  bool is_asked_by_us(const httplib::Request& request) const {
    const auto is_here = [&](const std::string& name) {
      return name == fmt::format("127.0.0.1:{}", port) || name == fmt::format("localhost:{}", port);
    };
    const std::string origin = request.get_header_value("Origin"), scheme = "http://";
    return is_here(request.get_header_value("Host")) &&
           (origin.empty() || (origin.starts_with(scheme) && is_here(origin.substr(scheme.size()))));
  }

  void answer_engine(const httplib::Request& request, httplib::Response& response) {
    try {
      if (request.body.find('\n') != std::string::npos) throw std::runtime_error("a request is one line");
      response.set_content(engines.ask(request.matches[1], request.body), "application/json");
    } catch (const std::exception& error) {
      response.status = 500;
      response.set_content(error.what(), "text/plain; charset=utf-8");
    }
  }

  // A mistake on disk is an answer too: the page tells it.
  void answer_example(const httplib::Request& request, httplib::Response& response) {
    const std::lock_guard one(derives);
    json answer;
    try {
      answer = first_example(start, specs);
    } catch (const std::exception& error) {
      answer = {{"problems", error.what()}};
    }
    const std::string edition = std::to_string(std::hash<std::string>()(answer.dump()));
    if (request.get_param_value("edition") == edition) answer = json::object();
    answer["edition"] = edition;
    response.set_content(answer.dump(), "application/json");
  }

  void answer_page(httplib::Response& response) {
    const std::lock_guard one(derives);
    try {
      response.set_content(served_page(start, specs, engine), "text/html; charset=utf-8");
    } catch (const std::exception& error) {
      response.status = 500;
      response.set_content(error.what(), "text/plain; charset=utf-8");
    }
  }
};

PageServer::PageServer(const std::string& start, const std::filesystem::path& specs,
                       const std::filesystem::path& engine, const std::filesystem::path& program, int port)
    : parts_(new Parts(start, specs, engine, program)) {
  served_page(start, specs, engine);  // tells at once why there is none
  httplib::Server& server = parts_->server;
  server.new_task_queue = [] { return new httplib::ThreadPool(16); };
  server.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
    if (parts_->is_asked_by_us(request)) return httplib::Server::HandlerResponse::Unhandled;
    response.status = 403;
    return httplib::Server::HandlerResponse::Handled;
  });
  server.Get("/", [this](const httplib::Request&, httplib::Response& response) { parts_->answer_page(response); });
  server.Get("/example", [this](const httplib::Request& request, httplib::Response& response) {
    parts_->answer_example(request, response);
  });
  const char* const engine_name = R"(/engine/([0-9a-z-]{1,40}))";
  server.Post(engine_name, [this](const httplib::Request& request, httplib::Response& response) {
    parts_->answer_engine(request, response);
  });
  server.Delete(engine_name, [this](const httplib::Request& request, httplib::Response&) {
    parts_->engines.end(request.matches[1]);
  });
  const char* const here = "127.0.0.1";
  parts_->port = port > 0 && server.bind_to_port(here, port) ? port : server.bind_to_any_port(here);
  if (parts_->port <= 0) throw std::runtime_error("no port is free on 127.0.0.1. Fix: -o FILE writes the page");
}

PageServer::~PageServer() = default;

std::string PageServer::address() const { return fmt::format("http://127.0.0.1:{}/", parts_->port); }
void PageServer::run() { parts_->server.listen_after_bind(); }
void PageServer::stop() {
  while (!parts_->server.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  parts_->server.stop();
}

}  // namespace cdot::play
