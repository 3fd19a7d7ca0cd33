/// Functions that are compiled for several instruction sets and called in the one that the machine has.
#pragma once

namespace thimble::wide {

/// Such a function: what is called is picked at each call, since a test may have chosen another instruction set.
template <class Function>
struct Kernel;
template <class Result, class... Arguments>
struct Kernel<Result(Arguments...)> {
  Result (*(*picked)())(Arguments...);
  Result operator()(Arguments... arguments) const { return picked()(arguments...); }
};

}  // namespace thimble::wide

/// Defines the kernel `name` that a header declares, behind the functions of that name in the namespaces of all
/// instruction sets.
// NOLINTBEGIN(bugprone-macro-parentheses): a name that is declared has none.
#define THIMBLE_KERNEL(name) \
  HWY_EXPORT(name);          \
  constinit const decltype(name) name = {[] { return &HWY_DYNAMIC_DISPATCH(name); }}
// NOLINTEND(bugprone-macro-parentheses)
