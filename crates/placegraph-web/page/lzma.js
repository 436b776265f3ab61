// Unpacks LZMA, as `xz --format=lzma` writes it: a fourth smaller than what browsers unpack themselves. After Igor Pavlov's
// specification; the names of the parts of the state are those of it.

const HALF = 1024;
const STATES = 12;
const POS_STATES = 16;
const HEADER_BYTES = 13;

const probabilities = (n) => new Uint16Array(n).fill(HALF);

/** A decoder of lengths: `choice` of three ranges, each a tree. */
class Lengths {
  choice = probabilities(2);
  low = probabilities(POS_STATES * 8);
  mid = probabilities(POS_STATES * 8);
  high = probabilities(256);

  decode(bits, posState) {
    if (!bits.bit(this.choice, 0)) return bits.tree(this.low, posState * 8, 3);
    if (!bits.bit(this.choice, 1)) return 8 + bits.tree(this.mid, posState * 8, 3);
    return 16 + bits.tree(this.high, 0, 8);
  }
}

/** The range decoder. */
class Bits {
  constructor(packed) {
    this.packed = packed;
    this.at = HEADER_BYTES + 1;
    this.range = 0xffffffff;
    this.code = 0;
    for (let k = 0; k < 4; k += 1) this.code = (this.code << 8) | packed[this.at++];
    this.code >>>= 0;
  }

  #normalize() {
    if (this.range >= 0x1000000) return;
    this.range = (this.range << 8) >>> 0;
    this.code = ((this.code << 8) | this.packed[this.at++]) >>> 0;
  }

  bit(table, index) {
    const p = table[index];
    const bound = (this.range >>> 11) * p;
    let bit = 0;
    if (this.code < bound) {
      this.range = bound;
      table[index] = p + ((2048 - p) >>> 5);
    } else {
      this.range -= bound;
      this.code -= bound;
      table[index] = p - (p >>> 5);
      bit = 1;
    }
    this.#normalize();
    return bit;
  }

  /** Bits of equal probability. */
  direct(n) {
    let value = 0;
    for (let k = 0; k < n; k += 1) {
      this.range >>>= 1;
      const bit = this.code >= this.range ? 1 : 0;
      if (bit) this.code -= this.range;
      value = value * 2 + bit;
      this.#normalize();
    }
    return value;
  }

  tree(table, from, n) {
    let node = 1;
    for (let k = 0; k < n; k += 1) node = node * 2 + this.bit(table, from + node);
    return node - (1 << n);
  }

  /** As `tree`, the lowest bit first. */
  reverseTree(table, from, n) {
    let [node, value] = [1, 0];
    for (let k = 0; k < n; k += 1) {
      const bit = this.bit(table, from + node);
      node = node * 2 + bit;
      value |= bit << k;
    }
    return value;
  }
}

/** The bytes that were packed. */
export function unpacked(packed) {
  const [lc, lp, pb] = [packed[0] % 9, Math.floor(packed[0] / 9) % 5, Math.floor(packed[0] / 45)];
  const bits = new Bits(packed);
  const [isMatch, isRep0Long] = [probabilities(STATES * POS_STATES), probabilities(STATES * POS_STATES)];
  const [isRep, isRepG0, isRepG1, isRepG2] = [0, 1, 2, 3].map(() => probabilities(STATES));
  const [posSlots, posSpecial, align] = [probabilities(4 * 64), probabilities(115), probabilities(16)];
  const literals = probabilities(0x300 << (lc + lp));
  const [matchLengths, repLengths] = [new Lengths(), new Lengths()];
  let out = new Uint8Array(packed.length * 4);
  let [n, state, rep0, rep1, rep2, rep3] = [0, 0, 0, 0, 0, 0];

  const literal = () => {
    const before = n ? out[n - 1] : 0;
    const from = 0x300 * (((n & ((1 << lp) - 1)) << lc) + (before >>> (8 - lc)));
    let symbol = 1;
    if (state >= 7) {
      let match = out[n - rep0 - 1];
      while (symbol < 0x100) {
        const matchBit = match >>> 7;
        match = (match << 1) & 0xff;
        const bit = bits.bit(literals, from + ((1 + matchBit) << 8) + symbol);
        symbol = symbol * 2 + bit;
        if (bit !== matchBit) break;
      }
    }
    while (symbol < 0x100) symbol = symbol * 2 + bits.bit(literals, from + symbol);
    return symbol & 0xff;
  };

  const distance = (length) => {
    const slot = bits.tree(posSlots, Math.min(length, 3) * 64, 6);
    if (slot < 4) return slot;
    const nDirect = (slot >>> 1) - 1;
    const base = (2 | (slot & 1)) * 2 ** nDirect;
    if (slot < 14) return base + bits.reverseTree(posSpecial, base - slot, nDirect);
    return base + bits.direct(nDirect - 4) * 16 + bits.reverseTree(align, 0, 4);
  };

  for (;;) {
    if (bits.at > packed.length) throw new Error("packed data is cut off");
    if (n + 300 > out.length) {
      const larger = new Uint8Array(out.length * 2);
      larger.set(out);
      out = larger;
    }
    const posState = n & ((1 << pb) - 1);
    if (!bits.bit(isMatch, state * POS_STATES + posState)) {
      out[n] = literal();
      n += 1;
      state = state < 4 ? 0 : state - (state < 10 ? 3 : 6);
      continue;
    }
    let length;
    if (bits.bit(isRep, state)) {
      if (!bits.bit(isRepG0, state)) {
        if (!bits.bit(isRep0Long, state * POS_STATES + posState)) {
          state = state < 7 ? 9 : 11;
          out[n] = out[n - rep0 - 1];
          n += 1;
          continue;
        }
      } else if (!bits.bit(isRepG1, state)) {
        [rep0, rep1] = [rep1, rep0];
      } else if (!bits.bit(isRepG2, state)) {
        [rep0, rep1, rep2] = [rep2, rep0, rep1];
      } else {
        [rep0, rep1, rep2, rep3] = [rep3, rep0, rep1, rep2];
      }
      length = repLengths.decode(bits, posState);
      state = state < 7 ? 8 : 11;
    } else {
      [rep1, rep2, rep3] = [rep0, rep1, rep2];
      length = matchLengths.decode(bits, posState);
      state = state < 7 ? 7 : 10;
      rep0 = distance(length);
      // The mark of the end.
      if (rep0 === 0xffffffff) return out.subarray(0, n);
    }
    if (rep0 >= n) throw new Error("packed data is damaged");
    for (let end = n + length + 2; n < end; n += 1) out[n] = out[n - rep0 - 1];
  }
}
