#pragma once

#include <string>

#include "server/store/session_store.h"

namespace rimlight::server::test {

/// The edit that makes revision `number` of a session, in epoch 7, with a state of its own.
StoredEdit numbered_edit(int number, const std::string& session = "a");

/// What such an edit may change besides: its user's steps, of which every third is an undo, and at
/// times a snapshot.
StoredRows numbered_rows(int number);
/// Holds a session to what those of edits 1 to `number` leave.
void expect_rows_of(int number, const StoredSession& session);

/// Stores it and waits; the refusal, or nothing.
std::string store_one(SessionStore& store, StoredEdit edit);

/// Runs SQL on a file that no store has open; the first value that it gives.
std::string run_sql(const std::string& file, const std::string& sql);

}  // namespace rimlight::server::test
