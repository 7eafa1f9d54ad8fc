// Contact points of a substep, in a buffer that is reused.

const WIDTH = 14;

export class Rows {
  #numbers = new Float64Array(WIDTH << 8);
  #length = 0;

  clear() {
    this.#length = 0;
  }

  /** Add a row: bodies a and b, the points on both [m], the unit normal from a to b, and a force of zero. */
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
