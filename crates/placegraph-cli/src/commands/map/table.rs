//! The table of a batch.

use anyhow::Result;

use super::batch::Done;
use super::result::skipped;
use crate::output::csv_row;

/// A row per map, as comma-separated values.
pub(super) struct Table<'a> {
    classes: &'a [&'a str],
    pub(super) text: String,
}

impl<'a> Table<'a> {
    /// The header.
    pub(super) fn new(classes: &'a [&'a str]) -> Self {
        let header = ["map", "status", "error"].iter().chain(classes);
        let header = header.chain(&["connections", "area_m2", "seconds"]).map(|&name| name.to_owned());
        Self { classes, text: csv_row(header) }
    }

    /// A row for `map`.
    pub(super) fn add(&mut self, map: &str, result: &Result<Done>) {
        let fields = match result {
            Ok(Done { time, document }) => {
                let status = if time.is_some() { "labeled" } else { "kept" };
                let seconds = time.map(|time| format!("{:.3}", time.as_secs_f64())).unwrap_or_default();
                let mut fields = vec![
                    map.to_owned(),
                    status.to_owned(),
                    document.errors.iter().cloned().chain(skipped(document)).collect::<Vec<_>>().join("; "),
                ];
                let n_places = |class: &&str| document.places.iter().filter(|p| p.class == **class).count();
                fields.extend(self.classes.iter().map(|class| n_places(class).to_string()));
                let area_m2: f64 = document.places.iter().map(|place| place.area_m2).sum();
                let connections = document.connections.len().to_string();
                fields.extend([connections, format!("{area_m2:.3}"), seconds]);
                fields
            }
            Err(error) => {
                let mut fields = vec![map.to_owned(), "failed".to_owned(), format!("{error:#}")];
                fields.resize(self.classes.len() + 6, String::new());
                fields
            }
        };
        self.text += &csv_row(fields.into_iter());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_escaped_and_rows_equally_long() {
        assert_eq!(
            csv_row(["a", "b,c", "say \"d\""].map(str::to_owned).into_iter()),
            "a,\"b,c\",\"say \"\"d\"\"\"\n"
        );
        let mut table = Table::new(&["corridor", "room"]);
        table.add("x.yaml", &Err(anyhow::anyhow!("expected a map, found none")));
        let lines: Vec<&str> = table.text.lines().collect();
        assert_eq!(lines[0], "map,status,error,corridor,room,connections,area_m2,seconds");
        assert_eq!(lines[1], "x.yaml,failed,\"expected a map, found none\",,,,,");
    }
}
