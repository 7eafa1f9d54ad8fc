// Contact points of a substep, in memory that is kept.

const WIDTH = 14;

export class Rows {
  #numbers = new Float64Array(WIDTH << 8);
  #length = 0;

  clear() {
    this.#length = 0;
  }

  /** Add a point: bodies a and b, the points on both, the normal from a to b; there is no force. */
  add(a, b, ax, ay, az, bx, by, bz, nx, ny, nz) {
    if (this.#length === this.#numbers.length) {
      const larger = new Float64Array(2 * this.#length);
      larger.set(this.#numbers);
      this.#numbers = larger;
    }
    this.#numbers.set([a, b, ax, ay, az, bx, by, bz, nx, ny, nz, 0, 0, 0], this.#length);
    this.#length += WIDTH;
  }

  numbers() {
    return this.#numbers.subarray(0, this.#length);
  }
}
