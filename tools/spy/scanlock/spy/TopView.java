// Copyright (c) 2026 The scanlock authors
// SPDX-License-Identifier: MIT
package scanlock.spy;

import java.awt.BasicStroke;
import java.awt.Color;
import java.awt.Graphics;
import java.awt.Graphics2D;
import java.awt.Point;
import java.awt.Rectangle;
import java.awt.RenderingHints;
import java.awt.Window;
import java.awt.event.MouseAdapter;
import java.awt.event.MouseEvent;
import java.awt.event.MouseWheelEvent;
import javax.swing.JDesktopPane;
import javax.swing.JInternalFrame;
import javax.swing.JPanel;
import javax.swing.SwingUtilities;
import javax.swing.event.InternalFrameAdapter;
import javax.swing.event.InternalFrameEvent;
import lcm.lcm.LCM;
import lcm.lcm.LCMSubscriber;

/** The plane seen from above, x to the right and y up, in metres, with a grid. Wheel: zoom; drag: move; double-click: fit. */
abstract class TopView extends JPanel implements LCMSubscriber {
  private static final int PLACE_STEP = 20;  // pixels
  private double centreX, centreY, pixelsPerMetre;
  private boolean fitting = true;
  private volatile String heading = "waiting for messages";
  private Point dragFrom;

  TopView() {
    setBackground(new Color(18, 20, 24));
    MouseAdapter mouse = new MouseAdapter() {
      @Override public void mouseWheelMoved(MouseWheelEvent event) {
        fitting = false;
        pixelsPerMetre *= Math.pow(1.15, -event.getPreciseWheelRotation());
        repaint();
      }
      @Override public void mousePressed(MouseEvent event) { dragFrom = event.getPoint(); }
      @Override public void mouseDragged(MouseEvent event) {
        fitting = false;
        centreX -= (event.getX() - dragFrom.x) / pixelsPerMetre;
        centreY += (event.getY() - dragFrom.y) / pixelsPerMetre;
        dragFrom = event.getPoint();
        repaint();
      }
      @Override public void mouseClicked(MouseEvent event) {
        if (event.getClickCount() == 2) fitting = true;
        repaint();
      }
    };
    addMouseListener(mouse);
    addMouseMotionListener(mouse);
    addMouseWheelListener(mouse);
  }

  /** Smallest x, smallest y, largest x, largest y of what there is to see, or null for nothing. */
  abstract double[] extent();

  abstract void paintContents(Graphics2D graphics);

  /** One line in the upper left corner. */
  void setHeading(String text) {
    heading = text;
    repaint();
  }

  int screenX(double x) { return (int) Math.round(getWidth() / 2.0 + (x - centreX) * pixelsPerMetre); }
  int screenY(double y) { return (int) Math.round(getHeight() / 2.0 - (y - centreY) * pixelsPerMetre); }

  @Override protected void paintComponent(Graphics plain) {
    super.paintComponent(plain);
    Graphics2D graphics = (Graphics2D) plain;
    if (fitting) fit();
    paintGrid(graphics);
    graphics.setRenderingHint(RenderingHints.KEY_ANTIALIASING, RenderingHints.VALUE_ANTIALIAS_ON);
    paintContents(graphics);
    graphics.setColor(Color.WHITE);
    graphics.drawString(heading, 8, 16);
  }

  private void fit() {
    double[] box = extent();
    if (box == null) box = new double[] {-10, -10, 10, 10};
    centreX = (box[0] + box[2]) / 2;
    centreY = (box[1] + box[3]) / 2;
    double width = Math.max(box[2] - box[0], 2), height = Math.max(box[3] - box[1], 2);
    pixelsPerMetre = 0.85 * Math.min(getWidth() / width, getHeight() / height);
  }

  private void paintGrid(Graphics2D graphics) {
    double step = gridStep();
    double left = centreX - getWidth() / 2.0 / pixelsPerMetre, right = 2 * centreX - left;
    double bottom = centreY - getHeight() / 2.0 / pixelsPerMetre, top = 2 * centreY - bottom;
    graphics.setStroke(new BasicStroke(1));
    graphics.setColor(new Color(44, 48, 56));
    for (double x = Math.ceil(left / step) * step; x < right; x += step)
      graphics.drawLine(screenX(x), 0, screenX(x), getHeight());
    for (double y = Math.ceil(bottom / step) * step; y < top; y += step)
      graphics.drawLine(0, screenY(y), getWidth(), screenY(y));
    graphics.setColor(Color.GRAY);
    graphics.drawString("grid " + (step < 1 ? String.valueOf(step) : String.valueOf((long) step)) + " m", 8,
        getHeight() - 8);
  }

  /** 1, 2 or 5 times a power of ten, some 80 pixels wide. */
  private double gridStep() {
    double wanted = 80 / pixelsPerMetre;
    double power = Math.pow(10, Math.floor(Math.log10(wanted)));
    for (double factor : new double[] {1, 2, 5})
      if (factor * power >= wanted) return factor * power;
    return 10 * power;
  }

  /** Shows the view in a window of the spy; it listens to the channel until the window is closed. */
  void open(JDesktopPane desktop, String title, final String channel) {
    final String literal = java.util.regex.Pattern.quote(channel);
    JInternalFrame frame = new JInternalFrame(title + " " + channel, true, true, true, true);
    frame.add(this);
    final TopView self = this;
    frame.addInternalFrameListener(new InternalFrameAdapter() {
      @Override public void internalFrameClosed(InternalFrameEvent event) {
        LCM.getSingleton().unsubscribe(literal, self);
      }
    });
    desktop.add(frame);
    frame.setVisible(true);
    moveToFreePlace(SwingUtilities.getWindowAncestor(desktop));
    try {
      frame.setMaximum(true);  // the spy opens a window with its own desktop for each view
    } catch (java.beans.PropertyVetoException stay) {
      frame.setSize(480, 360);
    }
    LCM.getSingleton().subscribe(literal, this);
  }

  /** Where no other window of the spy is, as long as there is room; many a desktop puts all into one corner. */
  private static void moveToFreePlace(Window window) {
    Rectangle screen = window.getGraphicsConfiguration().getBounds();
    Rectangle place = window.getBounds();
    for (place.y = screen.y; place.y + place.height <= screen.y + screen.height; place.y += PLACE_STEP)
      for (place.x = screen.x; place.x + place.width <= screen.x + screen.width; place.x += PLACE_STEP)
        if (isFree(place, window)) {
          window.setLocation(place.x, place.y);
          return;
        }
  }

  private static boolean isFree(Rectangle place, Window own) {
    for (Window other : Window.getWindows())
      if (other != own && other.isShowing() && place.intersects(other.getBounds())) return false;
    return true;
  }
}
