//! Bags of ROS 2 before Iron: a database of SQLite with the tables `topics` and `messages`. Messages may be compressed one by one by zstd.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Read;
use std::path::Path;

use rusqlite::config::DbConfig;
use rusqlite::limits::Limit;
use rusqlite::types::ValueRef;
use rusqlite::{Connection, Error, ErrorCode, OpenFlags};

use super::{
    GRID_TYPES, MapError, ReadOptions, RecordedGrid, does_not_unpack, is_wanted, max_bytes, open_stream,
    unpacked, wrong,
};

/// An open bag, which is not written to.
pub(super) struct Database(Connection);

/// What data that is compressed by zstd begins with; a message as CDR begins with a zero.
const ZSTD: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

impl Database {
    pub(super) fn open(path: &Path) -> Result<Self, MapError> {
        // Tells what is no file as for every other map.
        drop(open_stream(path)?);
        let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        Self::guarded(Connection::open_with_flags(path, flags).map_err(damaged)?)
    }

    pub(super) fn from_bytes(bytes: &[u8]) -> Result<Self, MapError> {
        let mut database = Connection::open_in_memory().map_err(damaged)?;
        database.deserialize_read_exact("main", bytes, bytes.len(), true).map_err(damaged)?;
        Self::guarded(database)
    }

    /// Nothing that a stranger's file defines is run, and damage is found before it is followed.
    fn guarded(database: Connection) -> Result<Self, MapError> {
        for (setting, is_on) in
            [(DbConfig::SQLITE_DBCONFIG_DEFENSIVE, true), (DbConfig::SQLITE_DBCONFIG_TRUSTED_SCHEMA, false)]
        {
            database.set_db_config(setting, is_on).map_err(damaged)?;
        }
        database.pragma_update(None, "cell_size_check", true).map_err(damaged)?;
        Ok(Self(database))
    }

    /// [`super::grids`] of this bag.
    pub(super) fn grids<E: From<MapError>>(
        &self,
        options: &ReadOptions,
        each: &mut dyn FnMut(RecordedGrid) -> Result<(), E>,
    ) -> Result<BTreeSet<String>, E> {
        let max_bytes = max_bytes(options.max_cells);
        let damaged = |error| too_large(&error, max_bytes).unwrap_or_else(|| damaged(error));
        let longest = i32::try_from(max_bytes).unwrap_or(i32::MAX);
        self.0.set_limit(Limit::SQLITE_LIMIT_LENGTH, longest).map_err(damaged)?;
        self.check_tables().map_err(damaged)??;
        let topics = self.topics().map_err(damaged)?;
        let mut messages =
            self.0.prepare("SELECT topic_id, timestamp, data FROM messages ORDER BY id").map_err(damaged)?;
        let mut rows = messages.query(()).map_err(damaged)?;
        while let Some(row) = rows.next().map_err(damaged)? {
            let topic = topics.get(&row.get(0).map_err(damaged)?);
            let Some(topic) = topic.filter(|topic| is_wanted(options, topic)) else { continue };
            let time: i64 = row.get(1).map_err(damaged)?;
            let ValueRef::Blob(data) = row.get_ref(2).map_err(damaged)? else {
                return Err(wrong("a message has no bytes".to_owned()).into());
            };
            let cdr = if data.starts_with(&ZSTD) { unpack_zstd(data, max_bytes)? } else { data.to_vec() };
            each(RecordedGrid { topic: topic.clone(), log_time_ns: time.max(0).cast_unsigned(), cdr })?;
        }
        Ok(topics.into_values().collect())
    }

    /// A view could ask for anything.
    fn check_tables(&self) -> Result<Result<(), MapError>, Error> {
        let mut found = self.0.prepare(
            "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND rootpage > 0 AND name IN ('topics', 'messages')",
        )?;
        let n: u32 = found.query_one((), |row| row.get(0))?;
        Ok(if n == 2 {
            Ok(())
        } else {
            Err(wrong("it has no tables topics and messages, as a bag has".to_owned()))
        })
    }

    /// Topics with grids.
    fn topics(&self) -> Result<BTreeMap<i64, String>, Error> {
        let mut topics = self.0.prepare("SELECT id, name, type, serialization_format FROM topics")?;
        let mut rows = topics.query(())?;
        let mut found = BTreeMap::new();
        while let Some(row) = rows.next()? {
            let (kind, format): (String, String) = (row.get(2)?, row.get(3)?);
            if GRID_TYPES.contains(&kind.as_str()) && format == "cdr" {
                found.insert(row.get(0)?, row.get(1)?);
            }
        }
        Ok(found)
    }
}

fn too_large(error: &Error, max_bytes: u64) -> Option<MapError> {
    (error.sqlite_error_code() == Some(ErrorCode::TooBig)).then_some(MapError::FileTooLarge { max_bytes })
}

#[expect(clippy::needless_pass_by_value, reason = "what `map_err` hands over")]
fn damaged(error: Error) -> MapError {
    wrong(format!("{error}; `ros2 bag reindex` and `sqlite3 .recover` mend such files"))
}

/// What is compressed by zstd in `data`, of at most `max_bytes` bytes.
fn unpack_zstd(data: &[u8], max_bytes: u64) -> Result<Vec<u8>, MapError> {
    let mut bytes = Vec::new();
    let most = max_bytes.saturating_add(1);
    unpacked(data)?.take(most).read_to_end(&mut bytes).map_err(|error| does_not_unpack(&error))?;
    if bytes.len() as u64 > max_bytes {
        return Err(MapError::FileTooLarge { max_bytes });
    }
    Ok(bytes)
}
