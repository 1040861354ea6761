/** Groups of moves have a value for each axis, so they change with the number of axes. */

/** @param {any[]} groups @param {(list: any[], empty: any) => any[]} change @param {(moves: any[]) => any[]} changeMoves */
function changed(groups, change, changeMoves) {
  return groups.map(({ line, way_points, time }) => {
    if (line) return { line: { ...line, distances: change(line.distances, { steps: 0 }) } };
    if (time) return { time: { ...time, moves: changeMoves(time.moves) } };
    const points = way_points.points.map((/** @type {any} */ { positions, speeds }) => ({
      positions: change(positions, { steps: 0 }),
      speeds: speeds && change(speeds, null),
    }));
    return { way_points: { ...way_points, points } };
  });
}

/** Groups with another axis, which stands still. @param {any[]} groups */
export const withAxis = (groups) =>
  changed(
    groups,
    (list, empty) => [...list, empty],
    (moves) => moves,
  );

/** Groups without an axis; a group without moves is removed. @param {any[]} groups @param {number} index */
export const withoutAxis = (groups, index) =>
  changed(
    groups,
    (list) => list.toSpliced(index, 1),
    (moves) =>
      moves
        .filter(({ axis }) => axis !== index)
        .map((/** @type {any} */ each) => (each.axis > index ? { ...each, axis: each.axis - 1 } : each)),
  ).filter(({ time }) => time?.moves.length !== 0);
