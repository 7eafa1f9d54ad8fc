"""A toy in pymunk and pygame: the example of docs/using_it_in_your_engine.md.

python pymunk_toy.py [--picture FILE.png]
Left button: a block falls. Right button: a ball flies from the left edge to the cursor. Frozen blocks are brown.
"""

import sys

import pygame
import pymunk

from stability_core.ports import attach

SIZE, FLOOR, BLOCK, RADIUS, GRAVITY = (640, 400), 380, (60, 20), 12, 900  # pixels, seconds


class Toy:
    """A space in pixels, with y downward as on pygame's screen, and the extension on it."""

    def __init__(self) -> None:
        self.space = pymunk.Space()
        self.space.gravity = 0, GRAVITY
        floor = pymunk.Segment(self.space.static_body, (-200, FLOOR + 10), (SIZE[0] + 200, FLOOR + 10), radius=10)
        floor.friction = 0.8
        self.space.add(floor)
        self.extension = attach(self.space)

    def add_block(self, x: float, y: float) -> pymunk.Body:
        """Add a block whose centre is at (x, y)."""
        block = pymunk.Body(2, pymunk.moment_for_box(2, BLOCK))
        block.position, shape = (x, y), pymunk.Poly.create_box(block, BLOCK)
        shape.friction = 0.8
        self.space.add(block, shape)
        return block

    def throw_ball(self, x: float, y: float) -> None:
        """Throw a ball from the left edge, which arrives at (x, y) after half a second."""
        ball = pymunk.Body(5, pymunk.moment_for_circle(5, 0, RADIUS))
        ball.position, ball.velocity = (0, 200), (2 * x, 2 * (y - 200) - GRAVITY / 4)
        self.space.add(ball, pymunk.Circle(ball, RADIUS))

    def play(self, frames: int = 1) -> None:
        """Play some frames."""
        for _ in range(frames):
            self.space.step(1 / 60)
            self.extension.update(1 / 60)

    def draw(self, screen: pygame.Surface) -> None:
        """Draw the space; frozen blocks are static bodies."""
        screen.fill("white")
        screen.fill("grey75", (0, FLOOR, *SIZE))
        for body in self.space.bodies:
            (shape,) = body.shapes
            if isinstance(shape, pymunk.Circle):
                pygame.draw.circle(screen, "firebrick", body.position, RADIUS)
                continue
            corners = [body.local_to_world(corner) for corner in shape.get_vertices()]
            pygame.draw.polygon(screen, "peru" if body.body_type == pymunk.Body.STATIC else "orange", corners)
            pygame.draw.polygon(screen, "white", corners, width=1)


if __name__ == "__main__":
    toy, display, clock = Toy(), pygame.display.set_mode(SIZE), pygame.time.Clock()
    for x, levels in ((500, 10), (300, 8)):  # one block a second
        for level in range(levels):
            toy.add_block(x + 12 * (level % 2), FLOOR - (level + 0.55) * BLOCK[1])
            toy.play(60)
    if sys.argv[1:2] == ["--picture"]:
        toy.throw_ball(290, 260)
        toy.play(36)
        toy.draw(display)
        sys.exit(pygame.image.save(display, sys.argv[2]))
    while not pygame.event.get(pygame.QUIT):
        for click in pygame.event.get(pygame.MOUSEBUTTONDOWN):
            (toy.add_block if click.button == 1 else toy.throw_ball)(*click.pos)
        toy.play()
        toy.draw(display)
        pygame.display.flip()
        clock.tick(60)
