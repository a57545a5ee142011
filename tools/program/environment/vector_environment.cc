#include "tools/program/environment/vector_environment.h"

#include <algorithm>
#include <stdexcept>

namespace slipbench {

VectorEnvironment::VectorEnvironment(const SceneFile& file, ActionKind action, std::size_t count, std::size_t threads)
    : places_(count), errors_(count) {
  if (count == 0 || threads == 0) throw std::invalid_argument("a vector environment of nothing");
  for (Place& place : places_) place.environment = std::make_unique<GraspEnvironment>(file, action);
  while (threads_.size() + 1 < std::min(threads, count)) threads_.emplace_back([this] { wait_for_work(); });
}

VectorEnvironment::~VectorEnvironment() {
  {
    const std::scoped_lock lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_all();
}

void VectorEnvironment::take_places() {
  std::unique_lock lock(mutex_);
  while (next_ < places_.size()) {
    const std::size_t mine = next_++;
    ++busy_;
    const auto& work = *work_;
    lock.unlock();
    try {
      work(places_[mine], mine);
    } catch (...) {
      errors_[mine] = std::current_exception();
    }
    lock.lock();
    --busy_;
  }
  if (busy_ == 0) changed_.notify_all();
}

void VectorEnvironment::wait_for_work() {
  std::uint64_t done = 0;
  while (true) {
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return stopped_ || round_ != done; });
      if (stopped_) return;
      done = round_;
    }
    take_places();
  }
}

void VectorEnvironment::for_each(const std::function<void(Place&, std::size_t)>& work) {
  {
    const std::scoped_lock lock(mutex_);
    work_ = &work;
    next_ = 0;
    ++round_;
  }
  changed_.notify_all();
  take_places();
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return next_ >= places_.size() && busy_ == 0; });
  }
  std::vector<std::exception_ptr> errors(places_.size());
  errors.swap(errors_);
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

void VectorEnvironment::reset(std::span<const std::uint64_t> seeds, std::span<const std::uint64_t> episodes,
                              std::span<const std::uint8_t> chosen) {
  for_each([&](Place& place, std::size_t i) {
    if (chosen[i] == 0) return;
    place.seed = seeds[i];
    place.episode = episodes[i];
    place.began = true;
    place.environment->reset(place.seed, place.episode);
  });
}

void VectorEnvironment::step(std::span<const double> actions) {
  // All of them before any environment goes on.
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if (!places_[i].environment->over()) GraspEnvironment::check_action(actions[i]);
  }
  for_each([&](Place& place, std::size_t i) {
    place.began = place.environment->over();
    if (place.began) {
      place.environment->reset(place.seed, ++place.episode);
    } else {
      place.environment->step(actions[i]);
    }
  });
}

}  // namespace slipbench
