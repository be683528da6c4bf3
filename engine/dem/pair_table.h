// SPDX-License-Identifier: MIT
// A hash table from pairs of indices to small values; erasing and inserting again costs no memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace verisim::dem {

/// Open addressing with linear probing; erased places are closed by shifting back, so that no
/// markers pile up. Grows by doubling at half full and never shrinks.
template <class Value>
class PairTable {
 public:
  PairTable() : slots_(16) {}

  std::size_t size() const { return size_; }

  void reserve(std::size_t count) {
    std::size_t capacity = slots_.size();
    while (capacity < 2 * count) capacity *= 2;
    if (capacity > slots_.size()) grow(capacity);
  }

  /// The value of (a, b), or null.
  Value* find(std::uint32_t a, std::uint32_t b) {
    const std::size_t place = place_of(key_of(a, b));
    return slots_[place].used ? &slots_[place].value : nullptr;
  }

  /// The value of (a, b), made from Value{} if it was not there.
  Value& at(std::uint32_t a, std::uint32_t b) {
    if (2 * (size_ + 1) > slots_.size()) grow(2 * slots_.size());
    const std::uint64_t key = key_of(a, b);
    Slot& slot = slots_[place_of(key)];
    if (!slot.used) {
      slot = {key, Value{}, true};
      ++size_;
    }
    return slot.value;
  }

  /// Removes (a, b); false if it was not there.
  bool erase(std::uint32_t a, std::uint32_t b) {
    std::size_t hole = place_of(key_of(a, b));
    if (!slots_[hole].used) return false;
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t next = (hole + 1) & mask; slots_[next].used; next = (next + 1) & mask) {
      const std::size_t wanted = hash(slots_[next].key) & mask;
      const bool may_move = ((next - wanted) & mask) >= ((next - hole) & mask);
      if (may_move) {
        slots_[hole] = slots_[next];
        hole = next;
      }
    }
    slots_[hole].used = false;
    --size_;
    return true;
  }

  void clear() {
    if (size_ == 0) return;
    for (Slot& slot : slots_) slot.used = false;
    size_ = 0;
  }

  /// Calls visit(a, b, value) for all, in an order that depends only on the calls made so far.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (const Slot& slot : slots_) {
      if (!slot.used) continue;
      visit(static_cast<std::uint32_t>(slot.key >> 32), static_cast<std::uint32_t>(slot.key),
            slot.value);
    }
  }

 private:
  struct Slot {
    std::uint64_t key = 0;
    Value value{};
    bool used = false;
  };

  static std::uint64_t key_of(std::uint32_t a, std::uint32_t b) {
    return (static_cast<std::uint64_t>(a) << 32) | b;
  }
  // Multiply and fold: neighbouring pairs must not share a run of places.
  static std::size_t hash(std::uint64_t key) {
    key *= 0x9E3779B97F4A7C15ull;
    return static_cast<std::size_t>(key ^ (key >> 32));
  }
  std::size_t place_of(std::uint64_t key) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t place = hash(key) & mask;
    while (slots_[place].used && slots_[place].key != key) place = (place + 1) & mask;
    return place;
  }
  void grow(std::size_t capacity) {
    std::vector<Slot> old(capacity);
    old.swap(slots_);
    for (Slot& slot : old) {
      if (slot.used) slots_[place_of(slot.key)] = std::move(slot);
    }
  }

  std::vector<Slot> slots_;
  std::size_t size_ = 0;
};

}  // namespace verisim::dem
