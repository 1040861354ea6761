//! Reads points of a profile (DESIGN B6) from a scenario or a table.

use crate::table::{BadTable, Rows, short};
use crate::{Json, JsonReader, Parts, ReadJson, ToParts};
use alloc::{borrow::ToOwned, format, string::String, vec, vec::Vec};
use stepscope_motion::moves::{MAX_POINTS, Point};

impl ReadJson for Point {
    fn read(&mut self, value: Json<'_>, reader: &mut JsonReader) -> bool {
        let expected = "a point's time in s and its position, such as [0.25, 12.5]";
        let Some(numbers) = value.list() else { return reader.reject_type(value, expected) };
        let [time_s, position] = &numbers[..] else {
            return reader.reject(format!("a point with {} numbers; use {expected}", numbers.len()));
        };
        reader.read_entry(0, *time_s, &mut self.time_s);
        reader.read_entry(1, *position, &mut self.position);
        true
    }

    fn blank() -> Self {
        Self::default()
    }
}

impl ToParts for Point {
    fn parts(&self) -> Parts<'_> {
        Parts::List(vec![&self.time_s, &self.position])
    }
}

/// Reads points from a table with a time in s and a position: the columns named `time_s` and `position` in the header,
/// otherwise the first two.
/// The first row decides between comma, semicolon and tab. With semicolon or tab, decimal commas are allowed.
/// Errors: [`BadTable`] with the first invalid line. The order of times is checked later.
pub fn points_of_table(table: &str) -> Result<Vec<Point>, BadTable> {
    let first = table.lines().find(|line| !line.trim().is_empty()).unwrap_or_default();
    let separator = [b';', b'\t'].into_iter().find(|mark| first.as_bytes().contains(mark)).unwrap_or(b',');
    let number = |text: &str| {
        let text = text.trim().trim_start_matches('+');
        let text = if separator == b',' { text.to_owned() } else { text.replace(',', ".") };
        serde_json::from_str::<f64>(&text).ok()
    };
    let mut rows = Rows::new(table, separator)?;
    let (mut points, mut columns, mut is_first) = (Vec::new(), (0, 1), true);
    while let Some((position, row)) = rows.next() {
        let header = core::mem::take(&mut is_first) && row.iter().all(|field| number(field).is_none());
        if header {
            let column = |name: &str| row.iter().position(|field| field.trim().eq_ignore_ascii_case(name));
            columns = column("time_s").zip(column("position")).unwrap_or(columns);
            continue;
        }
        let read = |column: usize, what: &str| {
            let text = row.get(column).map_or("", |field| field.trim());
            number(text).ok_or_else(|| {
                let given: String = short(text);
                rows.error_at(
                    position,
                    format!("the {what} is \u{201c}{given}\u{201d}; use a number, such as 0.25"),
                )
            })
        };
        points.push(Point { time_s: read(columns.0, "time in s")?, position: read(columns.1, "position")? });
        if points.len() > MAX_POINTS {
            return Err(
                rows.error_at(position, format!("more than {MAX_POINTS} points; use at most {MAX_POINTS}"))
            );
        }
    }
    if points.len() < 2 {
        return Err(rows.error_at(rows.position, format!("{} points; use 2 to {MAX_POINTS}", points.len())));
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Compact as _;
    use alloc::string::ToString;

    fn points(table: &str) -> Result<Vec<(f64, f64)>, String> {
        let points = points_of_table(table).map_err(|bad| bad.to_string())?;
        Ok(points.into_iter().map(|point| (point.time_s, point.position)).collect())
    }

    #[test]
    fn tables_of_all_kinds_give_the_same_points() {
        let expected = Ok(vec![(0.0, 1.5), (0.25, -2e3)]);
        for table in [
            "0,1.5\n0.25,-2e3\n",
            "\u{feff}time,travel\r\n0,1.5\r\n\r\n0.25,-2000",
            "name,position,time_s\nfirst,+1.5,0\nsecond,-2000,0.25\n",
            "t;x\n0;1,5\n0,25;-2000,0\n",
            "0\t1.5\n0.25\t-2000\n",
            "\"time_s\",\"position\"\n\"0\",\"1.5\"\n\"0.25\",\"-2000\"\n",
        ] {
            assert_eq!(points(table), expected, "{table}");
        }
    }

    #[test]
    fn errors_state_the_line() {
        for (table, expected) in [
            ("", "line 1: 0 points; use 2 to 4096"),
            ("time,position\n1,2\n", "line 3: 1 points; use 2 to 4096"),
            ("0,0\n\n1,x\n", "line 3: the position is \u{201c}x\u{201d}; use a number, such as 0.25"),
            ("a,b\n0,0\nNaN,1\n", "line 3: the time in s is \u{201c}NaN\u{201d}; use a number, such as 0.25"),
            ("0,0\n1\n", "line 2: the position is \u{201c}\u{201d}; use a number, such as 0.25"),
            ("0,x\n", "line 1: the position is \u{201c}x\u{201d}; use a number, such as 0.25"),
        ] {
            assert_eq!(points(table), Err(expected.into()), "{table:?}");
        }
        let many = "0,0\n".repeat(MAX_POINTS + 1);
        assert_eq!(points(&many), Err("line 4097: more than 4096 points; use at most 4096".into()));
    }

    #[test]
    fn a_point_is_a_pair_of_numbers() {
        let read =
            |json: &str| crate::part_from_json::<Point>(json).map_err(|problems| problems[0].to_string());
        assert_eq!(read("[0.25,-1]"), Ok(Point { time_s: 0.25, position: -1.0 }));
        for json in ["[1]", "[1,2,3]", "[]"] {
            assert!(read(json).unwrap_err().starts_with("a point with "), "{json}");
        }
        assert_eq!(Point { time_s: 0.5, position: -0.0 }.compact().to_string(), "[0.5,0.0]");
    }
}
