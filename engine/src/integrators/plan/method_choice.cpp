#include "integrators/plan/method_choice.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "integrators/plan/method_forecast.h"

namespace fluxfarm {
namespace {

std::string with_two_digits(double value) {
  std::ostringstream text;
  text.precision(2);
  text << value;
  return text.str();
}

std::string what_for(const Goal& goal) {
  if (goal.rel_error) return "least work until a relative error of " + with_two_digits(*goal.rel_error);
  if (goal.seconds) return "least squared error after " + with_two_digits(*goal.seconds) + " s";
  return "least squared error times work";
}

}  // namespace

double cost(const MethodForecast& forecast, const Goal& goal) {
  const double rel_mse = forecast.error * forecast.error;
  if (goal.rel_error) {
    const double work = std::sqrt(forecast.work * std::max(forecast.work_in_doubt, forecast.work));
    return reaches(forecast, goal) ? work : work * rel_mse / (*goal.rel_error * *goal.rel_error);
  }
  return goal.seconds ? rel_mse : rel_mse * forecast.work;
}

void choose_cheapest(MethodChoice& choice) {
  const MethodCandidate* best = nullptr;
  const MethodCandidate* second = nullptr;
  for (const MethodCandidate& candidate : choice.candidates) {
    if (!candidate.forecast) continue;
    const auto cheaper_than = [&](const MethodCandidate* other) {
      return other == nullptr || cost(*candidate.forecast, choice.goal) < cost(*other->forecast, choice.goal);
    };
    if (cheaper_than(best)) {
      second = best;
      best = &candidate;
    } else if (cheaper_than(second)) {
      second = &candidate;
    }
  }
  choice.method = best == nullptr ? choice.candidates.front().method : best->method;
  choice.reason = "no other method suits the scene";
  if (second == nullptr) return;
  const double least = cost(*best->forecast, choice.goal);
  choice.reason = "nothing that was tried has any noise";
  if (!(least > 0)) return;
  const double ratio = cost(*second->forecast, choice.goal) / least;
  choice.reason = what_for(choice.goal) + ": " + second->method + " has " + with_two_digits(ratio) + " times as much";
}

}  // namespace fluxfarm
