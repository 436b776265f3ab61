// What a page shows of a result: places, connections and the frame they are in.

/** One box around all points of `rings`, in cells. */
export function boxOf(rings) {
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  for (const ring of rings) {
    for (const [x, y] of ring) {
      box[0] = Math.min(box[0], x);
      box[1] = Math.min(box[1], y);
      box[2] = Math.max(box[2], x);
      box[3] = Math.max(box[3], y);
    }
  }
  return box;
}

/** Whether the point lies inside of the rings, holes left out. */
export function isInside(rings, [x, y]) {
  let inside = false;
  for (const ring of rings) {
    for (let i = 0, j = ring.length - 1; i < ring.length; j = i, i += 1) {
      const [ax, ay] = ring[i];
      const [bx, by] = ring[j];
      if (ay > y !== by > y && x < ax + ((y - ay) / (by - ay)) * (bx - ax)) inside = !inside;
    }
  }
  return inside;
}

/** A letter for every class, so that color is not all that tells them apart. */
export function lettersOf(names) {
  const taken = new Set();
  return names.map((name) => {
    const candidates = [...name.toUpperCase().replace(/[^\p{L}\p{N}]/gu, ""), ..."ABCDEFGHIJKLMNOPQRSTUVWXYZ"];
    const letter = candidates.find((candidate) => !taken.has(candidate)) ?? "?";
    taken.add(letter);
    return letter;
  });
}

export class MapData {
  constructor(data) {
    Object.assign(this, data);
    this.byId = new Map(data.places.map((place) => [place.id, place]));
    const letters = lettersOf(data.classes.map(({ name }) => name));
    this.classOf = new Map(
      data.classes.map((c, index) => [c.name, { ...c, index, letter: letters[index], css: `rgb(${c.color.join()})` }]),
    );
    for (const place of data.places) place.box = boxOf(place.rings);
    // The smallest first: of places that overlap on the screen, the pointer finds the smaller one.
    this.bySize = [...data.places].sort((a, b) => a.area_m2 - b.area_m2);
    this.isDoorway = (place) => place.width_m !== null && place.width_m !== undefined;
  }

  /** From cells, y down, to meters of the map frame. */
  toMeters([x, y]) {
    const { resolution_m: r, origin: o, height } = this;
    const [u, v, cos, sin] = [x * r, (height - y) * r, Math.cos(o.yaw_rad), Math.sin(o.yaw_rad)];
    return [o.x + u * cos - v * sin, o.y + u * sin + v * cos];
  }

  /** From meters of the map frame to cells, y down. */
  toCells([mx, my]) {
    const { resolution_m: r, origin: o, height } = this;
    const [dx, dy, cos, sin] = [mx - o.x, my - o.y, Math.cos(o.yaw_rad), Math.sin(o.yaw_rad)];
    return [(dx * cos + dy * sin) / r, height - (dy * cos - dx * sin) / r];
  }

  placeAt(point) {
    const [x, y] = point;
    return this.bySize.find(
      ({ box, rings }) => x >= box[0] && x <= box[2] && y >= box[1] && y <= box[3] && isInside(rings, point),
    );
  }

  neighbors(id) {
    const ends = this.connections.filter((c) => c.a === id || c.b === id).map((c) => (c.a === id ? c.b : c.a));
    return ends.map((end) => this.byId.get(end)).filter(Boolean);
  }

  called(id) {
    return this.byId.get(id)?.name ?? `place ${id}`;
  }

  /** The box of everything that is a place, or of the whole map. */
  box() {
    const box = boxOf(this.places.flatMap((place) => place.rings));
    return box[0] <= box[2] ? box : [0, 0, this.width, this.height];
  }

  /** A place in words, for tips and screen readers. */
  figures(place) {
    const lines = [
      `${place.class}, probability ${place.probability.toFixed(2)}`,
      `${place.area_m2.toFixed(1)} m², clearance ${place.clearance_m.toFixed(2)} m`,
    ];
    if (this.isDoorway(place)) {
      const sides = place.sides.map((id) => this.called(id)).join(" and ");
      lines.push(`${place.width_m.toFixed(2)} m wide, ${sides ? `joins ${sides}` : "joins nothing"}`);
    }
    return lines;
  }
}
